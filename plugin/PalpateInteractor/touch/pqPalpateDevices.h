// SPDX-License-Identifier: BSD-3-Clause
/// The devices with which one can touch: those that are plugged in, and two simulated ones, which
/// go through the same loop.
#pragma once

#include <QString>
#include <QVector>
#include <memory>

#include "haptic/profile/profile.h"
#include "haptic/recording/setup.h"
#include "haptic/transport/motion.h"
#include "haptic/transport/transport.h"

class pqRenderView;

/// A line of the list of devices.
struct pqPalpateDeviceName
{
  /// pqPalpateMouseDevice, pqPalpateHandDevice, or the path of a real device.
  QString Id;
  QString Name;
  /// Why the device cannot be opened; empty: it can.
  QString Fault;
  /// Whether the device has a button that a person can hold.
  bool HasButton = false;
};

extern const char* const pqPalpateMouseDevice;
extern const char* const pqPalpateHandDevice;

/// The mouse, the simulated hand, and the known devices that are plugged in. Each of the latter is
/// opened and closed, so that nothing may be touched meanwhile.
QVector<pqPalpateDeviceName> pqPalpateListDevices();

struct pqPalpateDevice
{
  std::unique_ptr<palpate::Transport> Transport;
  std::shared_ptr<const palpate::Profile> Profile;
  /// What a recording says about the device.
  palpate::RecordedSetup Setup;
};

/// A simulated board whose point follows a motion.
pqPalpateDevice pqPalpateSimulatedDevice(
  const std::shared_ptr<palpate::Clock>& clock, std::shared_ptr<palpate::Motion> motion);

/// The motion of the simulated hand, for ever: down into the body along −z and up again in four
/// seconds, in circles that widen on the way down.
/// @param depth The depth below the centre of the workspace, m at the device.
std::shared_ptr<palpate::Motion> pqPalpateHandMotion(double depth);

/// The rotation from the axes of a real device, x towards the person, y to the right, z up, to
/// those of the scene.
/// @param view The view in which right is right at the device; nullptr: the scene's y is up.
palpate::Mat3 pqPalpateAxesOfDevice(pqRenderView* view);

/// @throws palpate::InputError, palpate::BackendError the device cannot be opened.
pqPalpateDevice pqPalpateOpenDevice(const QString& path);
