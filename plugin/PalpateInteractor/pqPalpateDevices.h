// SPDX-License-Identifier: BSD-3-Clause
/// What a state space can be touched with: what is plugged in, and two simulated devices, which go
/// the same way through the same loop.
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
  /// pqPalpateMouseDevice, pqPalpateHandDevice, or the path of a real one.
  QString Id;
  QString Name;
  /// Why it cannot be opened; empty: it can.
  QString Fault;
  /// Whether a person can hold a button of it.
  bool HasButton = false;
};

extern const char* const pqPalpateMouseDevice;
extern const char* const pqPalpateHandDevice;

/// The mouse, the simulated hand, and the devices that are plugged in and known. Each of those is
/// opened and closed: nothing may be touched meanwhile.
QVector<pqPalpateDeviceName> pqPalpateListDevices();

struct pqPalpateDevice
{
  std::unique_ptr<palpate::Transport> Transport;
  std::shared_ptr<const palpate::Profile> Profile;
  /// What a recording says of it.
  palpate::RecordedSetup Setup;
};

/// A board that is not there, its point moved by someone.
pqPalpateDevice pqPalpateSimulatedDevice(
  const std::shared_ptr<palpate::Clock>& clock, std::shared_ptr<palpate::Motion> motion);

/// Down into the body along −z and up again in four seconds, in a circle that widens, for ever.
/// @param depth Below the centre of the workspace, m at the device.
std::shared_ptr<palpate::Motion> pqPalpateHandMotion(double depth);

/// The rotation from the axes of a real device, x towards the person, y to the right, z up, to
/// those of the scene.
/// @param view What is right at the device is right in it; nullptr: the scene's y is up.
palpate::Mat3 pqPalpateAxesOfDevice(pqRenderView* view);

/// @throws palpate::InputError, palpate::BackendError it cannot be opened.
pqPalpateDevice pqPalpateOpenDevice(const QString& path);
