// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateInteractorDock.h"

#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QGroupBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QKeySequence>
#include <QLabel>
#include <QMainWindow>
#include <QPushButton>
#include <QScrollArea>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QStandardItemModel>
#include <QStyle>
#include <QTableWidget>
#include <QToolBar>
#include <QVBoxLayout>
#include <algorithm>
#include <string>
#include <utility>

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqExpanderButton.h"
#include "pqFileChooserWidget.h"
#include "pqOutputPort.h"
#include "pqPalpateAbort.h"
#include "pqPalpateDevices.h"
#include "pqPalpateFault.h"
#include "pqPalpateFetch.h"
#include "pqPalpateForceGraph.h"
#include "pqPipelineSource.h"
#include "pqRenderView.h"
#include "pqServerManagerModel.h"
#include "vtkSMSourceProxy.h"

namespace
{
constexpr int FiguresInterval = 200; // ms
/// The role of an entry in the list of devices that says whether the device has a button.
constexpr int HasButtonRole = Qt::UserRole + 1;
constexpr const char* FaultStyle = "color: #a00000";

/// The columns of the table of tools.
enum ToolColumns
{
  ToolColumn,
  DeviceColumn,
  ForceColumn,
  StateColumn,
  NumberOfToolColumns
};

template <class T>
T* Named(T* widget, const char* name, const char* tip = "")
{
  widget->setObjectName(name);
  widget->setToolTip(tip);
  return widget;
}

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

/// Keeps a list from growing with its names, which may be long.
void KeepNarrow(QComboBox* choice)
{
  constexpr int letters = 7;
  choice->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  choice->setMinimumContentsLength(letters);
}

/// Identifies a port by its proxy. Names are chosen by the user, and two may be the same.
QString IdOf(pqOutputPort* port)
{
  return QString("%1:%2").arg(port->getSourceProxy()->GetGlobalID()).arg(port->getPortNumber());
}
}

pqPalpateInteractorDock::pqPalpateInteractorDock(QWidget* parent)
  : Superclass("Palpate", parent)
{
  new pqPalpateAbort(this);
  auto* content = Named(new QWidget(), "content");
  auto* column = new QVBoxLayout(content);
  const auto makeForm = [](QWidget* holder)
  {
    auto* form = new QFormLayout(holder);
    form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    return form;
  };
  const auto addGroup = [&](const char* title, const char* name)
  {
    auto* group = Named(new QGroupBox(title), name);
    column->addWidget(group);
    return makeForm(group);
  };
  // Settings that one does not need while touching are folded.
  QVector<QWidget*> folded;
  const auto addFold = [&](const char* title, const char* name)
  {
    auto* button = Named(new pqExpanderButton(), (std::string(name) + "Fold").c_str());
    button->setText(title);
    auto* holder = Named(new QWidget(), name);
    QObject::connect(button, &pqExpanderButton::toggled, holder, &QWidget::setVisible);
    column->addWidget(button);
    column->addWidget(holder);
    folded.push_back(holder);
    return makeForm(holder);
  };
  this->makeActions();
  this->makeChoices(addGroup("Touch", "touch"));
  this->ToolsGroup = Named(new QGroupBox("Tools"), "toolsGroup");
  column->addWidget(this->ToolsGroup);
  this->makeTools(new QVBoxLayout(this->ToolsGroup));
  this->makeFigures(addGroup("Live", "live"));
  this->GraphGroup = Named(new QGroupBox("Force over time"), "graph",
    "The last ten seconds, a sample a frame; the recording has every tick.");
  this->GraphGroup->setCheckable(true);
  this->GraphGroup->setChecked(false);
  new QVBoxLayout(this->GraphGroup);
  column->addWidget(this->GraphGroup);
  QObject::connect(
    this->GraphGroup, &QGroupBox::toggled, this, &pqPalpateInteractorDock::showGraph);
  this->makeSettings(addFold("Settings", "settings"));
  this->makeRecorder(addFold("Recording", "recording"));
  this->makePace(addFold("Pace of the loop", "pace"));
  column->addStretch();
  // Texts in the dock must not change the size of the view, so that its content is in a scroll
  // area.
  auto* area = Named(new QScrollArea(this), "area");
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  area->setWidget(content);
  // With this width nothing is cut off at the right, whatever is unfolded, with the scroll bar or
  // without.
  area->setMinimumWidth(
    content->minimumSizeHint().width() + area->verticalScrollBar()->sizeHint().width());
  for (QWidget* holder : folded)
  {
    holder->hide();
  }
  this->setWidget(area);

  this->follow(this->Touch);
  this->follow(this->ReducedTouch);
  QObject::connect(&this->ReducedTouch, &pqPalpateReducedTouch::toolLost, this,
    [this](int tool, const QString& why)
    {
      const QSignalBlocker blocker(this->DeviceOfTool[tool]);
      this->DeviceOfTool[tool]->setCurrentIndex(0);
      this->say(why, true);
    });
  this->FiguresTimer.setInterval(FiguresInterval);
  QObject::connect(&this->FiguresTimer, &QTimer::timeout, this,
    [this] { this->guard([this] { this->showFigures(); }); });

  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  const auto list = [this] { this->guard([this] { this->listSpaces(); }); };
  QObject::connect(model, &pqServerManagerModel::sourceRemoved, this, list);
  // While one touches, the touched body is updated each frame, which needs no new list.
  QObject::connect(model, &pqServerManagerModel::dataUpdated, this,
    [this, list]
    {
      if (!this->isTouching())
      {
        list();
      }
    });
  // The connection is queued: where touching ended because the server is gone, ParaView first has
  // to deal with that.
  QObject::connect(&this->Touch, &pqPalpateTouch::stopped, this, list, Qt::QueuedConnection);
  QObject::connect(
    &this->ReducedTouch, &pqPalpateReducedTouch::stopped, this, list, Qt::QueuedConnection);
  QObject::connect(model, &pqServerManagerModel::nameChanged, this, list);

  this->listSpaces();
  this->listDevices();
  this->showState();
}

void pqPalpateInteractorDock::makeChoices(QFormLayout* form)
{
  this->Space = Named(new QComboBox(), "space",
    "State spaces of the pipeline, from Precompute State Space or State Space Reader, and reduced "
    "models, from Build Reduced Model.");
  this->Device = Named(new QComboBox(), "device",
    "Mouse: press the left button on the body and drag, near a black dot where there is no rigid "
    "tool; the wheel goes in and out; with Ctrl first it moves the camera. Simulated hand: presses "
    "one place again and again.");
  this->Refresh = Named(new QPushButton("Refresh"), "refresh", "Look for devices again.");
  this->Start = Named(new QPushButton("Start"), "start");
  this->Message = Named(new QLabel(), "message");
  this->Message->setWordWrap(true);
  KeepNarrow(this->Space);
  KeepNarrow(this->Device);
  auto* devices = new QHBoxLayout();
  devices->addWidget(this->Device, 1);
  devices->addWidget(this->Refresh);
  form->addRow("State space", this->Space);
  form->addRow("Device", devices);
  form->addRow(this->Start);
  form->addRow(this->Message);
  QObject::connect(
    this->Refresh, &QPushButton::clicked, this, &pqPalpateInteractorDock::listDevices);
  QObject::connect(this->Start, &QPushButton::clicked, this->StartAction, &QAction::trigger);
}

void pqPalpateInteractorDock::makeTools(QVBoxLayout* column)
{
  this->Tools = Named(new QTableWidget(), "tools",
    "The tools of the reduced model. Each device has a loop of its own; they move one body. A tool "
    "that no device has moves with the body. A device that is chosen while the body is touched has "
    "the tool from then on, and the others go on.");
  this->Tools->setColumnCount(NumberOfToolColumns);
  this->Tools->setHorizontalHeaderLabels({ "Tool", "Device", "Force, N", "State" });
  this->Tools->verticalHeader()->hide();
  this->Tools->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  // The tool tip has the full text of the state.
  this->Tools->horizontalHeader()->setSectionResizeMode(StateColumn, QHeaderView::Stretch);
  this->Tools->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  this->Tools->setSelectionMode(QAbstractItemView::NoSelection);
  this->Tools->setEditTriggers(QAbstractItemView::NoEditTriggers);
  column->addWidget(this->Tools);
}

void pqPalpateInteractorDock::listTools()
{
  pqOutputPort* space = this->chosenSpace();
  const bool isReduced = space && pqPalpateGivesReducedModel(space);
  const int number = isReduced ? pqPalpateCountTools(space) : 0;
  this->ToolsGroup->setVisible(isReduced);
  this->Device->setVisible(!isReduced);
  for (QWidget* field : { this->Energy, this->Damping, this->Place, this->Force, this->Depth })
  {
    this->showRow(field, !isReduced);
  }
  for (QWidget* field : { this->Trust, this->StepTime })
  {
    this->showRow(field, isReduced);
  }
  QVector<QString> chosen;
  for (QComboBox* devices : std::as_const(this->DeviceOfTool))
  {
    chosen.push_back(devices->currentData().toString());
  }
  if (chosen.isEmpty())
  {
    chosen.push_back(pqPalpateMouseDevice);
  }
  // They are deleted at once, because the table would keep them until the next turn of the event
  // loop.
  qDeleteAll(this->DeviceOfTool);
  this->DeviceOfTool.clear();
  this->Tools->setRowCount(0);
  this->Tools->setRowCount(number);
  for (int tool = 0; tool < number; ++tool)
  {
    auto* devices = new QComboBox();
    KeepNarrow(devices);
    devices->setObjectName(QString("deviceOfTool%1").arg(tool));
    devices->addItem("None", QString());
    for (int i = 0; i < this->Device->count(); ++i)
    {
      devices->addItem(this->Device->itemText(i), this->Device->itemData(i));
      devices->setItemData(i + 1, this->Device->itemData(i, HasButtonRole), HasButtonRole);
      const bool isEnabled =
        qobject_cast<QStandardItemModel*>(this->Device->model())->item(i)->isEnabled();
      qobject_cast<QStandardItemModel*>(devices->model())->item(i + 1)->setEnabled(isEnabled);
    }
    devices->setCurrentIndex(
      std::max(0, devices->findData(tool < chosen.size() ? chosen[tool] : QString())));
    QObject::connect(devices, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
      [this, tool] { this->guard([this, tool] { this->chooseDevice(tool); }); });
    this->DeviceOfTool.push_back(devices);
    this->Tools->setCellWidget(tool, DeviceColumn, devices);
    this->Tools->setItem(tool, ToolColumn, new QTableWidgetItem(QString::number(tool)));
    this->Tools->setItem(tool, ForceColumn, new QTableWidgetItem());
    this->Tools->setItem(tool, StateColumn, new QTableWidgetItem("closed"));
  }
  constexpr int mostRows = 6;
  const int rowHeight = this->Tools->verticalHeader()->defaultSectionSize();
  this->Tools->setFixedHeight(this->Tools->horizontalHeader()->sizeHint().height() +
    rowHeight * std::min(number, mostRows) + 2 * this->Tools->frameWidth());
}

void pqPalpateInteractorDock::chooseDevice(int tool)
{
  this->enableSettings();
  if (!this->ReducedTouch.isRunning())
  {
    return;
  }
  QComboBox* devices = this->DeviceOfTool[tool];
  QString fault = this->whyTaken(tool);
  if (fault.isEmpty())
  {
    fault = this->ReducedTouch.setDevice(tool, devices->currentData().toString());
  }
  if (!fault.isEmpty())
  {
    const QSignalBlocker blocker(devices);
    devices->setCurrentIndex(std::max(0, devices->findData(this->ReducedTouch.device(tool))));
  }
  this->say(fault, true);
}

QString pqPalpateInteractorDock::whyTaken(int tool) const
{
  const QString device = this->DeviceOfTool[tool]->currentData().toString();
  if (device.isEmpty() || device == pqPalpateHandDevice)
  {
    return {};
  }
  for (int other = 0; other < this->DeviceOfTool.size(); ++other)
  {
    if (other != tool && this->DeviceOfTool[other]->currentData() == device)
    {
      return QString("%1 has tool %2: one device has one tool. Choose another device for tool %3.")
        .arg(this->DeviceOfTool[tool]->currentText())
        .arg(other)
        .arg(tool);
    }
  }
  return {};
}

void pqPalpateInteractorDock::showRow(QWidget* field, bool shown)
{
  field->setVisible(shown);
  auto* form = qobject_cast<QFormLayout*>(field->parentWidget()->layout());
  form->labelForField(field)->setVisible(shown);
}

void pqPalpateInteractorDock::makeActions()
{
  this->StartAction = new QAction(this);
  this->StartAction->setObjectName("startAction");
  this->StartAction->setShortcut(QKeySequence("Ctrl+Shift+T"));
  QObject::connect(this->StartAction, &QAction::triggered, this,
    [this] { this->guard([this] { this->startOrStop(); }); });
  if (auto* window = qobject_cast<QMainWindow*>(pqCoreUtilities::mainWidget()))
  {
    auto* bar = Named(new QToolBar("Palpate", window), "PalpateToolbar");
    bar->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    bar->addAction(this->StartAction);
    window->addToolBar(bar);
  }
}

void pqPalpateInteractorDock::makeRecorder(QFormLayout* form)
{
  this->Records = Named(new QCheckBox("Every tick"), "records",
    "Writes what the device says and what it is sent into a table that ParaView opens, and that "
    "palpate-servo replays.");
  this->RecordingFile = Named(new pqFileChooserWidget(), "recordingFile",
    "A new file is made at each start: run.csv, run-2.csv, …");
  // The loop runs on the client, and its recording is written there.
  this->RecordingFile->setServer(nullptr);
  this->RecordingFile->setForceSingleFile(true);
  this->RecordingFile->setAcceptAnyFile(true);
  this->RecordingFile->setExtension("Recordings (*.csv)");
  this->RecordingFile->setSingleFilename(QDir::home().filePath("touch.csv"));
  this->RecordingFile->setEnabled(false);
  this->Recorded = Named(new QLabel(), "recorded");
  this->Recorded->setWordWrap(true);
  form->addRow("Record", this->Records);
  form->addRow("File", this->RecordingFile);
  form->addRow(this->Recorded);
  QObject::connect(this->Records, &QCheckBox::toggled, this,
    [this](bool records) { this->RecordingFile->setEnabled(records); });
}

void pqPalpateInteractorDock::makeSettings(QFormLayout* form)
{
  const pqPalpateRun::Settings settings;
  this->WorkspaceScale = Named(NumberBox(settings.WorkspaceScale, 1000, 0.1, ""), "workspaceScale",
    "Metres in the scene for a metre at the device. Of real devices.");
  this->WorkspaceScale->setSpecialValueText("fits the body");
  this->FollowsCamera = Named(new QCheckBox("Turns with the camera"), "followsCamera",
    "What is right at the device is right in the view; else its axes are those of the scene, y "
    "up.");
  this->FollowsCamera->setChecked(settings.FollowsCamera);
  this->ForceScale = Named(NumberBox(settings.ForceScale, 1000, 0.1, ""), "forceScale",
    "Newtons at the device for a newton of the body.");
  this->ForceLimit = Named(NumberBox(settings.ForceLimit, 100, 0.5, " N"), "forceLimit",
    "Largest force at the device, N. Never above what the device gives.");
  this->ForceLimit->setSpecialValueText("the device's");
  this->Bonded = Named(new QCheckBox("Also pulls"), "bonded",
    "The tool is bonded to what it touches. The mouse always is.");
  this->Bonded->setChecked(settings.Bonded);
  this->ReleaseForce = Named(NumberBox(settings.ReleaseForce, 100, 0.5, " N"), "releaseForce",
    "The tool lets go where the body pulls with more than this.");
  this->ReleaseForce->setSpecialValueText("never");
  this->Friction = Named(NumberBox(settings.Friction, 10, 0.1, ""), "friction",
    "Coefficient of friction of a rigid tool: it sticks to the body until it is pulled aside with "
    "more than this share of the force with which it presses.");
  this->Friction->setSpecialValueText("none");
  this->Grasps = Named(new QCheckBox("With the last button"), "grasps",
    "A rigid tool that presses near an active node takes hold of it, and lets go with the button. "
    "With the mouse that is Ctrl.");
  this->Grasps->setChecked(settings.GraspsWithButton);
  this->NeedsButton = Named(new QCheckBox("Only while the button is held"), "needsButton",
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
  form->addRow("Grasp", this->Grasps);
  this->InTissue = Named(new QCheckBox("In the colour of tissue"), "inTissue",
    "The body at rest is seen in the colour of tissue, and the pressure on it, or how far it is "
    "moved, over that; else in ParaView's colours from blue to red.");
  this->InTissue->setChecked(settings.InTissue);
  form->addRow("Force", this->NeedsButton);
  form->addRow("Body", this->InTissue);
  for (QDoubleSpinBox* box : { this->WorkspaceScale, this->ForceScale, this->ForceLimit,
         this->ReleaseForce, this->Friction })
  {
    QObject::connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
      &pqPalpateInteractorDock::sendSettings);
  }
  for (QCheckBox* box :
    { this->FollowsCamera, this->Bonded, this->Grasps, this->NeedsButton, this->InTissue })
  {
    QObject::connect(box, &QCheckBox::toggled, this, &pqPalpateInteractorDock::sendSettings);
  }
  QObject::connect(
    this->Bonded, &QCheckBox::toggled, this, &pqPalpateInteractorDock::enableSettings);
  QObject::connect(this->Space, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
    &pqPalpateInteractorDock::listTools);
  for (QComboBox* choice : { this->Space, this->Device })
  {
    QObject::connect(choice, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
      &pqPalpateInteractorDock::enableSettings);
  }
}

void pqPalpateInteractorDock::enableSettings()
{
  pqOutputPort* space = this->chosenSpace();
  const bool isReduced = space && pqPalpateGivesReducedModel(space);
  const bool isRigid = space && !isReduced && pqPalpateHasRigidTool(space);
  const auto hasButtonOf = [](const QComboBox* devices)
  { return devices->currentData(HasButtonRole).toBool(); };
  const bool hasButton = isReduced
    ? std::any_of(this->DeviceOfTool.begin(), this->DeviceOfTool.end(), hasButtonOf)
    : hasButtonOf(this->Device);
  const auto isRealIn = [](const QComboBox* devices)
  {
    const QString device = devices->currentData().toString();
    return !device.isEmpty() && device != pqPalpateMouseDevice && device != pqPalpateHandDevice;
  };
  this->NeedsButton->setEnabled(isReduced
      ? std::any_of(this->DeviceOfTool.begin(), this->DeviceOfTool.end(), isRealIn)
      : isRealIn(this->Device));
  if (isReduced)
  {
    // The tool of a reduced body is bonded, and its coupling was made for these scales.
    this->Bonded->setEnabled(false);
    this->ReleaseForce->setEnabled(false);
    this->Friction->setEnabled(false);
    this->Grasps->setEnabled(hasButton);
    this->ForceScale->setEnabled(!this->isTouching());
    this->WorkspaceScale->setEnabled(!this->isTouching());
    return;
  }
  this->ForceScale->setEnabled(true);
  this->WorkspaceScale->setEnabled(true);
  this->Bonded->setEnabled(!isRigid);
  this->ReleaseForce->setEnabled(isRigid || this->Bonded->isChecked());
  this->Friction->setEnabled(isRigid);
  this->Grasps->setEnabled(isRigid && hasButton);
}

QLabel* pqPalpateInteractorDock::addFigure(
  QFormLayout* form, const char* title, const char* name, const char* tip)
{
  auto* label = Named(new QLabel(), name, tip);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  label->setWordWrap(true);
  form->addRow(title, label);
  return label;
}

void pqPalpateInteractorDock::makeFigures(QFormLayout* form)
{
  this->Force =
    this->addFigure(form, "Force", "force", "That is sent to the device, and that of the body.");
  this->Depth = this->addFigure(form, "Depth", "depth",
    "How deep a rigid tool is in the body at rest, or how far the tool has moved its node.");
  this->Place = this->addFigure(form, "Place", "place",
    "Of the tool in the space: the node that it moves and its branch, or how much deeper a rigid "
    "tool can go before the space ends.");
  this->Trust = this->addFigure(form, "Trust", "trust",
    "How far the body is moved, of how far its model was trained for: to about 1 it is inside; "
    "above 2 forces are not to be trusted.");
  this->State = this->addFigure(form, "State", "state", "Of the loop, and of the tool.");
  this->Missed =
    this->addFigure(form, "Missed ticks", "missed", "That should have been and were not, of all.");
}

void pqPalpateInteractorDock::makePace(QFormLayout* form)
{
  this->Rates = this->addFigure(
    form, "Rates", "rates", "Ticks of the loop and frames of the view in a second.");
  this->Lateness = this->addFigure(form, "Lateness", "lateness",
    "How late ticks began after their time: half of them less than, 99 %, all.");
  this->StepTime = this->addFigure(
    form, "Step", "stepTime", "What a step of the body took: half of them less than, 99 %.");
  this->Energy = this->addFigure(form, "Energy balance", "energy",
    "What the hand has put in less what the body stores; below zero the loop has made energy.");
  this->Damping =
    this->addFigure(form, "Added damping", "damping", "Against energy of the loop's own making.");
}

void pqPalpateInteractorDock::listSpaces()
{
  const QString chosen = this->Space->currentData().toString();
  const QSignalBlocker blocker(this->Space);
  this->Space->clear();
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
  {
    for (pqOutputPort* port : source->getOutputPorts())
    {
      if (pqPalpateGivesStateSpace(port) || pqPalpateGivesReducedModel(port))
      {
        this->Space->addItem(source->getSMName(), IdOf(port));
      }
    }
  }
  const int index = this->Space->findData(chosen);
  this->Space->setCurrentIndex(index >= 0 ? index : this->Space->count() - 1);
  // The lists' signals are blocked here, so these are called directly.
  this->listTools();
  this->enableSettings();
  this->showState();
}

pqOutputPort* pqPalpateInteractorDock::chosenSpace() const
{
  const QString chosen = this->Space->currentData().toString();
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
  {
    for (pqOutputPort* port : source->getOutputPorts())
    {
      if (IdOf(port) == chosen)
      {
        return port;
      }
    }
  }
  return nullptr;
}

void pqPalpateInteractorDock::listDevices()
{
  const QString chosen = this->Device->currentData().toString();
  this->Device->clear();
  auto* items = qobject_cast<QStandardItemModel*>(this->Device->model());
  QString faults;
  for (const pqPalpateDeviceName& device : pqPalpateListDevices())
  {
    this->Device->addItem(device.Name, device.Id);
    const int row = this->Device->count() - 1;
    this->Device->setItemData(row, device.HasButton, HasButtonRole);
    if (!device.Fault.isEmpty())
    {
      items->item(row)->setEnabled(false);
      this->Device->setItemData(row, device.Fault, Qt::ToolTipRole);
      faults += (faults.isEmpty() ? "" : "\n") + device.Name + ": " + device.Fault;
    }
  }
  const int index = this->Device->findData(chosen);
  this->Device->setCurrentIndex(index >= 0 ? index : 0);
  this->listTools();
  this->enableSettings();
  this->say(faults, true);
}

void pqPalpateInteractorDock::startOrStop()
{
  if (this->isTouching())
  {
    this->stopTouching();
    return;
  }
  pqOutputPort* space = this->chosenSpace();
  auto* view = qobject_cast<pqRenderView*>(pqActiveObjects::instance().activeView());
  if (!space)
  {
    this->say("There is no state space. Make one with Precompute State Space, or open a .palpate "
              "file, or make a reduced model with Build Reduced Model, and press Apply.",
      true);
    return;
  }
  if (!view)
  {
    this->say("Make a render view the active one: the touched body is shown there.", true);
    return;
  }
  this->say({}, false);
  this->sendSettings();
  this->Recorded->clear();
  const QString recording =
    this->Records->isChecked() ? this->RecordingFile->singleFilename() : QString();
  if (this->Records->isChecked() && recording.isEmpty())
  {
    this->say("Name the file of the recording, or switch it off.", true);
    return;
  }
  QString fault;
  if (!pqPalpateGivesReducedModel(space))
  {
    fault = this->Touch.start(space, view, this->Device->currentData().toString(), recording);
  }
  else
  {
    QVector<QString> devices;
    for (int tool = 0; tool < this->DeviceOfTool.size() && fault.isEmpty(); ++tool)
    {
      devices.push_back(this->DeviceOfTool[tool]->currentData().toString());
      fault = this->whyTaken(tool);
    }
    if (fault.isEmpty())
    {
      fault = this->ReducedTouch.start(space, view, devices, recording);
    }
  }
  if (!fault.isEmpty())
  {
    this->say(fault, true);
  }
}

void pqPalpateInteractorDock::sendSettings()
{
  pqPalpateRun::Settings settings;
  settings.WorkspaceScale = this->WorkspaceScale->value();
  settings.FollowsCamera = this->FollowsCamera->isChecked();
  settings.ForceScale = this->ForceScale->value();
  settings.ForceLimit = this->ForceLimit->value();
  settings.Bonded = this->Bonded->isChecked();
  settings.ReleaseForce = this->ReleaseForce->value();
  settings.Friction = this->Friction->value();
  settings.GraspsWithButton = this->Grasps->isEnabled() && this->Grasps->isChecked();
  // The tick counts also while it is disabled: it is not given up because another device is chosen.
  settings.NeedsButton = this->NeedsButton->isChecked();
  settings.InTissue = this->InTissue->isChecked();
  this->Touch.setSettings(settings);
  this->ReducedTouch.setSettings(settings);
}

void pqPalpateInteractorDock::showState()
{
  const bool runs = this->isTouching();
  this->Start->setText(runs ? "Stop" : "Start");
  this->StartAction->setText(runs ? "Stop Touching" : "Touch");
  this->StartAction->setIcon(
    this->style()->standardIcon(runs ? QStyle::SP_MediaStop : QStyle::SP_MediaPlay));
  this->StartAction->setToolTip((runs ? "Stop touching, with zero force"
                                      : "Touch the state space that the dock Palpate names") +
    QString(" (%1)").arg(this->StartAction->shortcut().toString(QKeySequence::NativeText)));
  // Listing devices opens them, which must not happen while one touches.
  this->Refresh->setEnabled(!runs);
  this->Records->setEnabled(!runs);
  this->RecordingFile->setEnabled(!runs && this->Records->isChecked());
  this->Space->setEnabled(!runs);
  this->Device->setEnabled(!runs);
  this->enableSettings();
  if (runs == this->FiguresTimer.isActive())
  {
    return;
  }
  if (runs)
  {
    if (this->Graph)
    {
      this->Graph->clear();
    }
    this->FiguresTimer.start();
  }
  else
  {
    this->FiguresTimer.stop();
    this->State->setText("closed");
    for (int tool = 0; tool < this->Tools->rowCount(); ++tool)
    {
      this->Tools->item(tool, StateColumn)->setText("closed");
      this->Tools->item(tool, ForceColumn)->setText({});
    }
  }
}

void pqPalpateInteractorDock::showReducedFigures()
{
  const pqPalpateReducedTouch::Figures f = this->ReducedTouch.figures();
  this->State->setText("body " + f.Outcome);
  this->State->setStyleSheet(f.Outcome == "converged" ? "" : FaultStyle);
  this->StepTime->setText(
    QString("%1 / %2 µs").arg(f.StepTime[0], 0, 'f', 0).arg(f.StepTime[1], 0, 'f', 0));
  this->Trust->setText(
    QString("%1%2").arg(f.Trust, 0, 'f', 2).arg(f.IsTrusted ? "" : ", not to be trusted"));
  this->Trust->setStyleSheet(f.IsTrusted ? "" : FaultStyle);
  for (int tool = 0; tool < std::min<int>(f.Tools.size(), this->Tools->rowCount()); ++tool)
  {
    const pqPalpateReducedTouch::ToolFigures& figures = f.Tools[tool];
    this->Tools->item(tool, ToolColumn)
      ->setText(QString("%1 (%2)").arg(tool).arg(figures.ActiveNode));
    this->Tools->item(tool, ForceColumn)->setText(QString::number(figures.Force, 'f', 3));
    this->Tools->item(tool, ForceColumn)
      ->setToolTip(QString("%1 N at the device, %2 N of the body")
                     .arg(figures.Force, 0, 'f', 3)
                     .arg(figures.BodyForce, 0, 'f', 3));
    this->Tools->item(tool, StateColumn)->setText(figures.State);
    this->Tools->item(tool, StateColumn)->setToolTip(figures.State);
  }
  this->showPace(f, " steps");
}

void pqPalpateInteractorDock::showPace(const pqPalpateRun::Pace& pace, const char* unit)
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
  if (this->Records->isChecked())
  {
    const quint64 missing = pace.NotRecorded;
    this->Recorded->setText(QString("%1 ticks%2")
                              .arg(pace.Recorded)
                              .arg(missing > 0 ? QString(", %1 missing").arg(missing) : QString()));
  }
  if (pace.Problem != this->Problem)
  {
    this->Problem = pace.Problem;
    this->say(pace.Problem, true);
  }
}

void pqPalpateInteractorDock::showFigures()
{
  if (this->ReducedTouch.isRunning())
  {
    this->showReducedFigures();
    return;
  }
  this->State->setStyleSheet("");
  const pqPalpateTouch::Figures f = this->Touch.figures();
  this->State->setText(f.State + ", " + f.Contact);
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
  this->showPace(f, "");
}

void pqPalpateInteractorDock::showGraph(bool shown)
{
  if (shown && !this->Graph)
  {
    this->Graph = Named(new pqPalpateForceGraph(), "forceGraph");
    this->GraphGroup->layout()->addWidget(this->Graph);
  }
  if (this->Graph)
  {
    this->Graph->setVisible(shown);
  }
}

void pqPalpateInteractorDock::say(const QString& text, bool isFault)
{
  this->Message->setText(text);
  this->Message->setStyleSheet(isFault ? FaultStyle : "");
  this->Message->setVisible(!text.isEmpty());
}

void pqPalpateInteractorDock::guard(const std::function<void()>& body)
{
  const QString fault = pqPalpateFault(body);
  if (!fault.isEmpty())
  {
    this->say(fault, true);
  }
}

void pqPalpateInteractorDock::stopTouching()
{
  this->Touch.stop();
  this->ReducedTouch.stop();
}

void pqPalpateInteractorDock::follow(pqPalpateRun& run)
{
  QObject::connect(&run, &pqPalpateRun::started, this, &pqPalpateInteractorDock::showState);
  QObject::connect(&run, &pqPalpateRun::stopped, this,
    [this](const QString& why)
    {
      this->showState();
      this->say(why, !why.isEmpty());
    });
  QObject::connect(&run, &pqPalpateRun::sampled, this,
    [this](double time, double force, double bodyForce)
    {
      if (this->Graph)
      {
        this->Graph->addSample(time, force, bodyForce);
      }
    });
  QObject::connect(&run, &pqPalpateRun::recorded, this,
    [this](const QString& file, quint64 ticks, const QString& fault)
    {
      this->Recorded->setText(
        QString("%1 ticks in %2%3").arg(ticks).arg(file, fault.isEmpty() ? "" : ". " + fault));
    });
}

void pqPalpateInteractorDock::closeEvent(QCloseEvent* event)
{
  this->stopTouching();
  this->Superclass::closeEvent(event);
}
