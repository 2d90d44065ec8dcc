// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateInteractorDock.h"

#include <QAction>
#include <QComboBox>
#include <QFormLayout>
#include <QGroupBox>
#include <QKeySequence>
#include <QLabel>
#include <QMainWindow>
#include <QPushButton>
#include <QScrollArea>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QStyle>
#include <QToolBar>
#include <QVBoxLayout>
#include <string>

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqCoreUtilities.h"
#include "pqExpanderButton.h"
#include "pqOutputPort.h"
#include "pqPalpateAbort.h"
#include "pqPalpateDevicesPanel.h"
#include "pqPalpateDockParts.h"
#include "pqPalpateFault.h"
#include "pqPalpateFetch.h"
#include "pqPalpateFiguresPanel.h"
#include "pqPalpateForceGraph.h"
#include "pqPalpateRecordingPanel.h"
#include "pqPalpateSettingsPanel.h"
#include "pqPipelineSource.h"
#include "pqRenderView.h"
#include "pqServerManagerModel.h"
#include "vtkPVDataInformation.h"
#include "vtkSMSourceProxy.h"

namespace
{
constexpr int FiguresInterval = 200; // ms

/// Identifies a port by its proxy. Names are chosen by the user, and two may be the same.
QString IdOf(pqOutputPort* port)
{
  return QString("%1:%2").arg(port->getSourceProxy()->GetGlobalID()).arg(port->getPortNumber());
}

/// Whether a body can be cut along what a port gives. What shows the touched body is no sheet.
bool CanBeSheet(pqOutputPort* port)
{
  return port->getSourceProxy()->GetXMLName() != std::string("TouchStateSpace") &&
    port->getDataInformation()->DataSetTypeIsA("vtkPolyData");
}
}

pqPalpateInteractorDock::pqPalpateInteractorDock(QWidget* parent)
  : Superclass("Palpate", parent)
{
  new pqPalpateAbort(this);
  auto* content = pqPalpateNamed(new QWidget(), "content");
  auto* column = new QVBoxLayout(content);
  const auto makeForm = [](QWidget* holder)
  {
    auto* form = new QFormLayout(holder);
    form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    return form;
  };
  const auto addGroup = [&](const char* title, const char* name)
  {
    auto* group = pqPalpateNamed(new QGroupBox(title), name);
    column->addWidget(group);
    return makeForm(group);
  };
  // Settings that one does not need while touching are folded.
  QVector<QWidget*> folded;
  const auto addFold = [&](const char* title, const char* name)
  {
    auto* button = pqPalpateNamed(new pqExpanderButton(), (std::string(name) + "Fold").c_str());
    button->setText(title);
    auto* holder = pqPalpateNamed(new QWidget(), name);
    QObject::connect(button, &pqExpanderButton::toggled, holder, &QWidget::setVisible);
    column->addWidget(button);
    column->addWidget(holder);
    folded.push_back(holder);
    return makeForm(holder);
  };
  this->makeActions();
  this->makeChoices(addGroup("Touch", "touch"));
  auto* tools = pqPalpateNamed(new QGroupBox("Tools"), "toolsGroup");
  column->addWidget(tools);
  this->Devices->addTable(tools);
  this->Figures = new pqPalpateFiguresPanel(this);
  this->Figures->addLive(addGroup("Live", "live"));
  this->GraphGroup = pqPalpateNamed(new QGroupBox("Force over time"), "graph",
    "The last ten seconds, a sample a frame; the recording has every tick.");
  this->GraphGroup->setCheckable(true);
  this->GraphGroup->setChecked(false);
  new QVBoxLayout(this->GraphGroup);
  column->addWidget(this->GraphGroup);
  QObject::connect(
    this->GraphGroup, &QGroupBox::toggled, this, &pqPalpateInteractorDock::showGraph);
  this->Settings = new pqPalpateSettingsPanel(addFold("Settings", "settings"), this);
  this->makeCut(addFold("Cut", "cut"));
  this->Recording = new pqPalpateRecordingPanel(addFold("Recording", "recording"), this);
  this->Figures->addPace(addFold("Pace of the loop", "pace"));
  column->addStretch();
  // Texts in the dock must not change the size of the view, so that its content is in a scroll
  // area.
  auto* area = pqPalpateNamed(new QScrollArea(this), "area");
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

  const auto choiceChanged = QOverload<int>::of(&QComboBox::currentIndexChanged);
  QObject::connect(this->Space, choiceChanged, this, &pqPalpateInteractorDock::listTools);
  QObject::connect(this->Space, choiceChanged, this, &pqPalpateInteractorDock::enableSettings);
  QObject::connect(this->Devices, &pqPalpateDevicesPanel::deviceChanged, this,
    &pqPalpateInteractorDock::enableSettings);
  QObject::connect(this->Devices, &pqPalpateDevicesPanel::deviceOfToolChanged, this,
    [this](int tool) { this->guard([this, tool] { this->chooseDevice(tool); }); });
  QObject::connect(
    this->Settings, &pqPalpateSettingsPanel::changed, this, &pqPalpateInteractorDock::sendSettings);
  this->follow(this->Touch);
  this->follow(this->ReducedTouch);
  QObject::connect(&this->ReducedTouch, &pqPalpateReducedTouch::toolLost, this,
    [this](int tool, const QString& why)
    {
      this->Devices->showDevice(tool, {});
      this->say(why, true);
    });
  this->FiguresTimer.setInterval(FiguresInterval);
  QObject::connect(&this->FiguresTimer, &QTimer::timeout, this,
    [this] { this->guard([this] { this->showFigures(); }); });

  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  const auto list = [this] { this->guard([this] { this->listSpaces(); }); };
  QObject::connect(model, &pqServerManagerModel::sourceRemoved, this, list);
  QObject::connect(model, &pqServerManagerModel::dataUpdated, this,
    [this, list](pqPipelineSource* source)
    {
      if (!this->isTouching())
      {
        list();
        return;
      }
      // While one touches, the touched body is updated each frame, and what hangs on it. This needs
      // no new list, but a sheet that is made meanwhile does.
      for (pqOutputPort* port : source->getOutputPorts())
      {
        if (CanBeSheet(port) && this->Sheet->findData(IdOf(port)) < 0)
        {
          this->guard([this] { this->listSheets(); });
        }
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
  this->Space = pqPalpateNamed(new QComboBox(), "space",
    "State spaces of the pipeline, from Precompute State Space or State Space Reader, and reduced "
    "models, from Build Reduced Model.");
  pqPalpateKeepNarrow(this->Space);
  form->addRow("State space", this->Space);
  this->Devices = new pqPalpateDevicesPanel(this);
  this->Devices->addList(form);
  this->Start = pqPalpateNamed(new QPushButton("Start"), "start");
  this->Message = pqPalpateNamed(new QLabel(), "message");
  this->Message->setWordWrap(true);
  form->addRow(this->Start);
  form->addRow(this->Message);
  QObject::connect(this->Start, &QPushButton::clicked, this->StartAction, &QAction::trigger);
  QObject::connect(
    this->Devices, &pqPalpateDevicesPanel::refreshed, this, &pqPalpateInteractorDock::listDevices);
}

void pqPalpateInteractorDock::makeCut(QFormLayout* form)
{
  this->Sheet = pqPalpateNamed(new QComboBox(), "sheet",
    "Surfaces of the pipeline, such as the source Plane. The sheet begins outside the body, as "
    "that "
    "is seen now, and ends inside it.");
  pqPalpateKeepNarrow(this->Sheet);
  form->addRow("Sheet", this->Sheet);
  this->Cut = pqPalpateNamed(new QPushButton("Cut Now"), "cutNow",
    "Cuts the body along the sheet, as it is held or pressed now, and has its space computed anew. "
    "Until that is done, the body is felt as it was. Ctrl+Z takes the filters away again.");
  form->addRow(this->Cut);
  QObject::connect(
    this->Cut, &QPushButton::clicked, this, [this] { this->guard([this] { this->cutNow(); }); });
}

void pqPalpateInteractorDock::listSheets()
{
  const QString chosen = this->Sheet->currentData().toString();
  this->Sheet->clear();
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
  {
    for (pqOutputPort* port : source->getOutputPorts())
    {
      if (CanBeSheet(port))
      {
        this->Sheet->addItem(source->getSMName(), IdOf(port));
      }
    }
  }
  const int index = this->Sheet->findData(chosen);
  this->Sheet->setCurrentIndex(index >= 0 ? index : this->Sheet->count() - 1);
}

void pqPalpateInteractorDock::cutNow()
{
  pqOutputPort* space = this->chosenSpace();
  if (!space || pqPalpateGivesReducedModel(space))
  {
    this->say("There is no state space whose body could be cut: choose one above.", true);
    return;
  }
  pqOutputPort* sheet = chosenIn(this->Sheet);
  if (!sheet)
  {
    this->say("There is no sheet to cut along. Make one with the source Plane, for instance, which "
              "begins outside the body and ends inside it, and press Apply.",
      true);
    return;
  }
  this->say("The body is being cut. It is felt as it was until the new space is there.", false);
  pqPalpateCutNow(space, sheet, this->Touch.heldTool());
  this->say("The body is cut.", false);
}

void pqPalpateInteractorDock::listTools()
{
  pqOutputPort* space = this->chosenSpace();
  const bool isReduced = space && pqPalpateGivesReducedModel(space);
  if (isReduced)
  {
    this->Devices->listTools(pqPalpateCountTools(space));
  }
  else
  {
    this->Devices->listOneTool();
  }
  this->Figures->showRows(isReduced);
}

void pqPalpateInteractorDock::chooseDevice(int tool)
{
  this->enableSettings();
  if (!this->ReducedTouch.isRunning())
  {
    return;
  }
  QString fault = this->Devices->whyTaken(tool);
  if (fault.isEmpty())
  {
    fault = this->ReducedTouch.setDevice(tool, this->Devices->devicesOfTools()[tool]);
  }
  if (!fault.isEmpty())
  {
    this->Devices->showDevice(tool, this->ReducedTouch.device(tool));
  }
  this->say(fault, true);
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
    auto* bar = pqPalpateNamed(new QToolBar("Palpate", window), "PalpateToolbar");
    bar->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    bar->addAction(this->StartAction);
    window->addToolBar(bar);
  }
}

void pqPalpateInteractorDock::enableSettings()
{
  pqOutputPort* space = this->chosenSpace();
  pqPalpateSettingsPanel::Situation situation;
  situation.IsReduced = space && pqPalpateGivesReducedModel(space);
  situation.IsRigid = space && !situation.IsReduced && pqPalpateHasRigidTool(space);
  situation.IsExplored = space && pqPalpateIsExploredAroundHand(space);
  situation.HasCut = space && pqPalpateHasCut(space);
  situation.HasButton = this->Devices->hasButton();
  situation.HasRealDevice = this->Devices->hasRealDevice();
  situation.IsTouching = this->isTouching();
  this->Settings->enable(situation);
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
  this->listSheets();
  // The lists' signals are blocked here, so these are called directly.
  this->listTools();
  this->enableSettings();
  this->showState();
}

pqOutputPort* pqPalpateInteractorDock::chosenSpace() const
{
  return chosenIn(this->Space);
}

pqOutputPort* pqPalpateInteractorDock::chosenIn(const QComboBox* list)
{
  const QString chosen = list->currentData().toString();
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
  const QString faults = this->Devices->listDevices();
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
  this->Recording->clear();
  const bool records = this->Recording->records();
  const QString recording = records ? this->Recording->file() : QString();
  if (records && recording.isEmpty())
  {
    this->say("Name the file of the recording, or switch it off.", true);
    return;
  }
  QString fault;
  if (!pqPalpateGivesReducedModel(space))
  {
    fault = this->Touch.start(space, view, this->Devices->device(), recording);
  }
  else
  {
    const QVector<QString> devices = this->Devices->devicesOfTools();
    for (int tool = 0; tool < devices.size() && fault.isEmpty(); ++tool)
    {
      fault = this->Devices->whyTaken(tool);
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
  const pqPalpateRun::Settings settings = this->Settings->settings();
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
  this->Devices->setRunning(runs);
  this->Recording->setRunning(runs);
  this->Space->setEnabled(!runs);
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
    this->Figures->showClosed();
    this->Devices->showClosed();
  }
}

void pqPalpateInteractorDock::showFigures()
{
  const auto showAll = [this](const auto& figures)
  {
    this->Figures->show(figures);
    this->Recording->showTicks(figures.Recorded, figures.NotRecorded);
    if (figures.Problem != this->Problem)
    {
      this->Problem = figures.Problem;
      this->say(figures.Problem, true);
    }
  };
  if (this->ReducedTouch.isRunning())
  {
    const pqPalpateReducedTouch::Figures figures = this->ReducedTouch.figures();
    this->Devices->showFigures(figures.Tools);
    showAll(figures);
    return;
  }
  showAll(this->Touch.figures());
}

void pqPalpateInteractorDock::showGraph(bool shown)
{
  if (shown && !this->Graph)
  {
    this->Graph = pqPalpateNamed(new pqPalpateForceGraph(), "forceGraph");
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
  this->Message->setStyleSheet(isFault ? pqPalpateFaultStyle : "");
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
    { this->Recording->showFile(file, ticks, fault); });
}

void pqPalpateInteractorDock::closeEvent(QCloseEvent* event)
{
  this->stopTouching();
  this->Superclass::closeEvent(event);
}
