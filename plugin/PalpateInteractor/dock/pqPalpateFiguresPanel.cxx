// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateFiguresPanel.h"

#include <QFormLayout>
#include <QLabel>

#include "pqPalpateDockParts.h"

namespace
{
QLabel* AddFigure(QFormLayout* form, const char* title, const char* name, const char* tip)
{
  auto* label = pqPalpateNamed(new QLabel(), name, tip);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  label->setWordWrap(true);
  form->addRow(title, label);
  return label;
}

void ShowRow(QWidget* field, bool shown)
{
  field->setVisible(shown);
  auto* form = qobject_cast<QFormLayout*>(field->parentWidget()->layout());
  form->labelForField(field)->setVisible(shown);
}
}

pqPalpateFiguresPanel::pqPalpateFiguresPanel(QObject* parent)
  : QObject(parent)
{
}

void pqPalpateFiguresPanel::addLive(QFormLayout* form)
{
  this->Force =
    AddFigure(form, "Force", "force", "That is sent to the device, and that of the body.");
  this->Depth = AddFigure(form, "Depth", "depth",
    "How deep a rigid tool is in the body at rest, or how far the tool has moved its node.");
  this->Place = AddFigure(form, "Place", "place",
    "Of the tool in the space: the node that it moves and its branch, or how much deeper a rigid "
    "tool can go before the space ends.");
  this->Mesh = AddFigure(form, "Mesh", "mesh",
    "How wrong the mesh makes the force of the body, as estimated with the space.");
  this->Tear = AddFigure(form, "Tear", "tear",
    "The area of the cut that is open, and where the work of the hand has gone: stored in the "
    "body, "
    "into tearing, and lost in tears that ran by themselves or when the hand let go.");
  this->Explored = AddFigure(form, "Explored", "explored",
    "States that were found around the hand since the start, explorers, and how many of the cells "
    "that the hand may be in within 0.4 s are known.");
  this->Trust = AddFigure(form, "Trust", "trust",
    "How far the body is moved, of how far its model was trained for: to about 1 it is inside; "
    "above 2 forces are not to be trusted.");
  this->State = AddFigure(form, "State", "state", "Of the loop, and of the tool.");
  this->Missed =
    AddFigure(form, "Missed ticks", "missed", "That should have been and were not, of all.");
}

void pqPalpateFiguresPanel::addPace(QFormLayout* form)
{
  this->Rates =
    AddFigure(form, "Rates", "rates", "Ticks of the loop and frames of the view in a second.");
  this->Lateness = AddFigure(form, "Lateness", "lateness",
    "How late ticks began after their time: half of them less than, 99 %, all.");
  this->StepTime = AddFigure(
    form, "Step", "stepTime", "What a step of the body took: half of them less than, 99 %.");
  this->Energy = AddFigure(form, "Energy balance", "energy",
    "What the hand has put in less what the body stores; below zero the loop has made energy.");
  this->Damping =
    AddFigure(form, "Added damping", "damping", "Against energy of the loop's own making.");
}

void pqPalpateFiguresPanel::showRows(bool isReduced)
{
  for (QWidget* field : { this->Energy, this->Damping, this->Place, this->Force, this->Depth })
  {
    ShowRow(field, !isReduced);
  }
  // They are shown where there is an estimate, and where something is explored.
  ShowRow(this->Mesh, false);
  ShowRow(this->Tear, false);
  ShowRow(this->Explored, false);
  for (QWidget* field : { this->Trust, this->StepTime })
  {
    ShowRow(field, isReduced);
  }
}

void pqPalpateFiguresPanel::showPace(const pqPalpateRun::Pace& pace, const char* unit)
{
  this->Rates->setText(QString("%1%2/s, view %3 /s")
                         .arg(pace.Rate, 0, 'f', 1)
                         .arg(*unit ? unit : " ")
                         .arg(pace.FrameRate, 0, 'f', 0));
  this->Lateness->setText(QString("%1 / %2 / %3 µs")
                            .arg(pace.Lateness[0], 0, 'f', 0)
                            .arg(pace.Lateness[1], 0, 'f', 0)
                            .arg(pace.Lateness[2], 0, 'f', 0));
  this->Missed->setText(QString("%1 of %2%3").arg(pace.Missed).arg(pace.Number).arg(unit));
}

void pqPalpateFiguresPanel::show(const pqPalpateTouch::Figures& f)
{
  this->State->setStyleSheet("");
  this->State->setText(f.State + ", " + f.Contact);
  this->showPace(f, "");
  this->Force->setText(
    QString("%1 N, body %2 N").arg(f.Force, 0, 'f', 3).arg(f.BodyForce, 0, 'f', 3));
  this->Depth->setText(f.Depth < 0
      ? QString("none")
      : QString("%1 mm%2").arg(1e3 * f.Depth, 0, 'f', 1).arg(f.Node >= 0 ? " moved" : " deep"));
  this->Energy->setText(QString("%1 mJ").arg(1e3 * f.Dissipated, 0, 'f', 3));
  this->Damping->setText(QString("%1 N·s/m").arg(f.Damping, 0, 'f', 3));
  QString place = f.Support.isEmpty() ? "none" : f.Support;
  if (f.Node >= 0)
  {
    place = QString("node %1, %2").arg(f.Node).arg(place);
  }
  if (f.Branch > 0)
  {
    place += QString(", branch %1").arg(f.Branch);
  }
  if (f.DepthLeft >= 0)
  {
    place += QString(", %1 mm left").arg(1e3 * f.DepthLeft, 0, 'f', 1);
  }
  this->Place->setText(place);
  ShowRow(this->Explored, !f.Explored.isEmpty());
  this->Explored->setText(f.Explored);
  ShowRow(this->Tear, f.HasCut);
  const double lost = f.HandWork - f.Stored - f.TornWork - f.FrictionWork;
  this->Tear->setText(QString("%1 cm²: %2 mJ = %3 stored + %4 torn + %5 rubbed + %6 lost")
                        .arg(1e4 * f.TornArea, 0, 'f', 2)
                        .arg(1e3 * f.HandWork, 0, 'f', 2)
                        .arg(1e3 * f.Stored, 0, 'f', 2)
                        .arg(1e3 * f.TornWork, 0, 'f', 2)
                        .arg(1e3 * f.FrictionWork, 0, 'f', 2)
                        .arg(1e3 * lost, 0, 'f', 2));
  const palpate::TouchMeshError& mesh = f.MeshError;
  ShowRow(this->Mesh, mesh.trust != palpate::MeshErrorTrust::none);
  const bool isReliable = mesh.trust == palpate::MeshErrorTrust::reliable;
  this->Mesh->setText(QString("± %1 N%2%3")
                        .arg(mesh.bound, 0, 'f', 3)
                        .arg(mesh.is_corrected ? ", corrected" : "")
                        .arg(isReliable ? "" : ", not to be trusted"));
  this->Mesh->setStyleSheet(isReliable ? "" : pqPalpateFaultStyle);
}

void pqPalpateFiguresPanel::show(const pqPalpateReducedTouch::Figures& f)
{
  this->State->setText("body " + f.Outcome);
  this->State->setStyleSheet(f.Outcome == "converged" ? "" : pqPalpateFaultStyle);
  this->showPace(f, " steps");
  this->StepTime->setText(
    QString("%1 / %2 µs").arg(f.StepTime[0], 0, 'f', 0).arg(f.StepTime[1], 0, 'f', 0));
  this->Trust->setText(
    QString("%1%2").arg(f.Trust, 0, 'f', 2).arg(f.IsTrusted ? "" : ", not to be trusted"));
  this->Trust->setStyleSheet(f.IsTrusted ? "" : pqPalpateFaultStyle);
}

void pqPalpateFiguresPanel::showClosed()
{
  this->State->setText("closed");
  ShowRow(this->Explored, false);
}
