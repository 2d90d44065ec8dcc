// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateSettingsPanel.h"

#include <QCheckBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLineEdit>
#include <QSpinBox>

#include "pqPalpateDockParts.h"

namespace
{
QDoubleSpinBox* NumberBox(double value, double most, double step, const char* suffix)
{
  auto* box = new QDoubleSpinBox();
  box->setDecimals(3);
  box->setRange(0, most);
  box->setSingleStep(step);
  box->setValue(value);
  box->setSuffix(suffix);
  box->setKeyboardTracking(false);
  return box;
}
}

pqPalpateSettingsPanel::pqPalpateSettingsPanel(QFormLayout* form, QObject* parent)
  : QObject(parent)
{
  const pqPalpateRun::Settings settings;
  this->WorkspaceScale = pqPalpateNamed(NumberBox(settings.WorkspaceScale, 1000, 0.1, ""),
    "workspaceScale", "Metres in the scene for a metre at the device. Of real devices.");
  this->WorkspaceScale->setSpecialValueText("fits the body");
  this->FollowsCamera = pqPalpateNamed(new QCheckBox("Turns with the camera"), "followsCamera",
    "What is right at the device is right in the view; else its axes are those of the scene, y "
    "up.");
  this->FollowsCamera->setChecked(settings.FollowsCamera);
  this->ForceScale = pqPalpateNamed(NumberBox(settings.ForceScale, 1000, 0.1, ""), "forceScale",
    "Newtons at the device for a newton of the body.");
  this->ForceLimit = pqPalpateNamed(NumberBox(settings.ForceLimit, 100, 0.5, " N"), "forceLimit",
    "Largest force at the device, N. Never above what the device gives.");
  this->ForceLimit->setSpecialValueText("the device's");
  this->Bonded = pqPalpateNamed(new QCheckBox("Also pulls"), "bonded",
    "The tool is bonded to what it touches. The mouse always is.");
  this->Bonded->setChecked(settings.Bonded);
  this->ReleaseForce = pqPalpateNamed(NumberBox(settings.ReleaseForce, 100, 0.5, " N"),
    "releaseForce", "The tool lets go where the body pulls with more than this.");
  this->ReleaseForce->setSpecialValueText("never");
  this->Friction = pqPalpateNamed(NumberBox(settings.Friction, 10, 0.1, ""), "friction",
    "Coefficient of friction of a rigid tool: it sticks to the body until it is pulled aside with "
    "more than this share of the force with which it presses.");
  this->Friction->setSpecialValueText("none");
  this->Toughness = pqPalpateNamed(NumberBox(settings.FractureToughness, 10000, 10, " J/m²"),
    "fractureToughness",
    "The energy that it takes to open an area of the cut, for a space with its stages. Soft tissue "
    "has 10 to 500 J/m². What is torn stays so until touching begins anew.");
  this->Toughness->setSpecialValueText("does not tear");
  this->Blade = pqPalpateNamed(new QCheckBox("Is a blade"), "blade",
    "The tool opens the cut of a space with its stages: it goes in where the cut begins or is "
    "open, "
    "and is drawn along the cut. What the tool holds when it becomes a blade stays held there, as "
    "by "
    "another hand.");
  this->BladeToughness = pqPalpateNamed(NumberBox(settings.BladeToughness, 10000, 10, " J/m²"),
    "bladeToughness", "The energy that it takes the blade to open an area of the cut.");
  this->BladeToughness->setSpecialValueText("as to tear");
  this->BladeStiffness =
    pqPalpateNamed(NumberBox(settings.BladeStiffness, 100000, 100, " N/m"), "bladeStiffness",
      "The stiffness of the tissue before the edge, which the space does not have.");
  this->BladeStiffness->setMinimum(1);
  this->BladeFriction = pqPalpateNamed(NumberBox(settings.BladeFriction, 100, 0.1, " N"),
    "bladeFriction", "The force that it takes to draw the blade through what is cut.");
  this->BladeFriction->setSpecialValueText("none");
  this->Grasps = pqPalpateNamed(new QCheckBox("With the last button"), "grasps",
    "A rigid tool that presses near an active node takes hold of it, and lets go with the button. "
    "With the mouse that is Ctrl.");
  this->Grasps->setChecked(settings.GraspsWithButton);
  this->NeedsButton = pqPalpateNamed(new QCheckBox("Only while the button is held"), "needsButton",
    "There is a force only as long as the first button of the device is held. Who lets go of it "
    "gets a force again when the tool was outside of the body. A device with motors and without a "
    "button is refused meanwhile. Of real devices.");
  this->NeedsButton->setChecked(settings.NeedsButton);
  form->addRow("Workspace scale", this->WorkspaceScale);
  form->addRow("Workspace", this->FollowsCamera);
  form->addRow("Force scale", this->ForceScale);
  form->addRow("Force limit", this->ForceLimit);
  form->addRow("Tool", this->Bonded);
  form->addRow("Lets go above", this->ReleaseForce);
  form->addRow("Friction", this->Friction);
  form->addRow("Toughness", this->Toughness);
  form->addRow("Blade", this->Blade);
  form->addRow("Its toughness", this->BladeToughness);
  form->addRow("Its stiffness", this->BladeStiffness);
  form->addRow("Its friction", this->BladeFriction);
  form->addRow("Grasp", this->Grasps);
  this->InTissue = pqPalpateNamed(new QCheckBox("In the colour of tissue"), "inTissue",
    "The body at rest is seen in the colour of tissue, and the pressure on it, or how far it is "
    "moved, over that; else in ParaView's colours from blue to red.");
  this->InTissue->setChecked(settings.InTissue);
  form->addRow("Force", this->NeedsButton);
  form->addRow("Body", this->InTissue);
  this->Explorers = pqPalpateNamed(
    new QSpinBox(), "explorers", "Programs on this machine that explore around the hand.");
  this->Explorers->setRange(0, 256);
  this->Explorers->setSpecialValueText("the cores less one");
  this->Endpoint = pqPalpateNamed(new QLineEdit(), "explorersEndpoint",
    "Where explorers of other machines come to, as tcp://*:5700, or where they listen, as "
    ">tcp://node1:5700,>tcp://node2:5700. Both sides need the keys.");
  this->Endpoint->setPlaceholderText("this machine alone");
  this->Keys = pqPalpateNamed(
    new QLineEdit(), "explorersKeys", "The folder of the keys, from palpate-explore --make-keys.");
  this->Keys->setPlaceholderText("new ones");
  form->addRow("Explorers", this->Explorers);
  form->addRow("Others at", this->Endpoint);
  form->addRow("Keys", this->Keys);
  for (QDoubleSpinBox* box :
    { this->WorkspaceScale, this->ForceScale, this->ForceLimit, this->ReleaseForce, this->Friction,
      this->Toughness, this->BladeToughness, this->BladeStiffness, this->BladeFriction })
  {
    QObject::connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
      &pqPalpateSettingsPanel::changed);
  }
  for (QCheckBox* box : { this->FollowsCamera, this->Bonded, this->Blade, this->Grasps,
         this->NeedsButton, this->InTissue })
  {
    QObject::connect(box, &QCheckBox::toggled, this, &pqPalpateSettingsPanel::changed);
  }
  QObject::connect(
    this->Bonded, &QCheckBox::toggled, this, [this] { this->enable(this->Present); });
}

pqPalpateRun::Settings pqPalpateSettingsPanel::settings() const
{
  pqPalpateRun::Settings settings;
  settings.WorkspaceScale = this->WorkspaceScale->value();
  settings.FollowsCamera = this->FollowsCamera->isChecked();
  settings.ForceScale = this->ForceScale->value();
  settings.ForceLimit = this->ForceLimit->value();
  settings.Bonded = this->Bonded->isChecked();
  settings.ReleaseForce = this->ReleaseForce->value();
  settings.Friction = this->Friction->value();
  settings.FractureToughness = this->Toughness->value();
  settings.IsBlade = this->Blade->isEnabled() && this->Blade->isChecked();
  settings.BladeToughness = this->BladeToughness->value();
  settings.BladeStiffness = this->BladeStiffness->value();
  settings.BladeFriction = this->BladeFriction->value();
  settings.GraspsWithButton = this->Grasps->isEnabled() && this->Grasps->isChecked();
  // The tick counts also while it is disabled: it is not given up because another device is chosen.
  settings.NeedsButton = this->NeedsButton->isChecked();
  settings.InTissue = this->InTissue->isChecked();
  settings.Explorers.Number = this->Explorers->value();
  settings.Explorers.Endpoint = this->Endpoint->text().trimmed();
  settings.Explorers.Keys = this->Keys->text().trimmed();
  return settings;
}

void pqPalpateSettingsPanel::enable(const Situation& situation)
{
  this->Present = situation;
  this->NeedsButton->setEnabled(situation.HasRealDevice);
  this->Toughness->setEnabled(situation.HasCut);
  for (QWidget* of : std::initializer_list<QWidget*>{
         this->Blade, this->BladeToughness, this->BladeStiffness, this->BladeFriction })
  {
    of->setEnabled(situation.HasCut && !situation.IsRigid && !situation.IsReduced);
  }
  for (QWidget* of : std::initializer_list<QWidget*>{ this->Explorers, this->Endpoint, this->Keys })
  {
    of->setEnabled(situation.IsExplored && !situation.IsTouching);
  }
  if (situation.IsReduced)
  {
    // The tool of a reduced body is bonded, and its coupling was made for these scales.
    this->Bonded->setEnabled(false);
    this->ReleaseForce->setEnabled(false);
    this->Friction->setEnabled(false);
    this->Grasps->setEnabled(situation.HasButton);
    this->ForceScale->setEnabled(!situation.IsTouching);
    this->WorkspaceScale->setEnabled(!situation.IsTouching);
    return;
  }
  this->ForceScale->setEnabled(true);
  this->WorkspaceScale->setEnabled(true);
  this->Bonded->setEnabled(!situation.IsRigid);
  this->ReleaseForce->setEnabled(situation.IsRigid || this->Bonded->isChecked());
  this->Friction->setEnabled(situation.IsRigid);
  this->Grasps->setEnabled(situation.IsRigid && situation.HasButton);
}
