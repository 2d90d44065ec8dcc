// SPDX-License-Identifier: BSD-3-Clause
/// The settings of touching that a person may change while it runs.
#pragma once

#include <QObject>

#include "pqPalpateRun.h"

class QCheckBox;
class QDoubleSpinBox;
class QFormLayout;
class QLineEdit;
class QSpinBox;

class pqPalpateSettingsPanel : public QObject
{
  Q_OBJECT
public:
  pqPalpateSettingsPanel(QFormLayout* form, QObject* parent);

  pqPalpateRun::Settings settings() const;

  /// What is touched, and with which devices.
  struct Situation
  {
    bool IsReduced = false;
    bool IsRigid = false; ///< a state space with a rigid tool
    bool HasButton = false;
    bool HasRealDevice = false;
    bool IsTouching = false;
    bool IsExplored = false; ///< a state space that is explored around the hand
    bool HasCut = false;     ///< a state space with the stages of a cut
  };
  /// Disables the settings that have no meaning now.
  void enable(const Situation& situation);

Q_SIGNALS:
  void changed();

private:
  QDoubleSpinBox* WorkspaceScale = nullptr;
  QCheckBox* FollowsCamera = nullptr;
  QDoubleSpinBox* ForceScale = nullptr;
  QDoubleSpinBox* ForceLimit = nullptr;
  QCheckBox* Bonded = nullptr;
  QDoubleSpinBox* ReleaseForce = nullptr;
  QDoubleSpinBox* Friction = nullptr;
  QDoubleSpinBox* Toughness = nullptr;
  QCheckBox* Blade = nullptr;
  QDoubleSpinBox* BladeToughness = nullptr;
  QDoubleSpinBox* BladeStiffness = nullptr;
  QDoubleSpinBox* BladeFriction = nullptr;
  QCheckBox* Grasps = nullptr;
  QCheckBox* NeedsButton = nullptr;
  QCheckBox* InTissue = nullptr;
  QSpinBox* Explorers = nullptr;
  QLineEdit* Endpoint = nullptr;
  QLineEdit* Keys = nullptr;
  Situation Present;
};
