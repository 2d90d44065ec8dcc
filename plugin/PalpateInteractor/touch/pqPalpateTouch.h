// SPDX-License-Identifier: BSD-3-Clause
/// Touches a state space of the pipeline with one device. It owns the servo loop, the body that the
/// loop touches, and the device.
///
/// A filter TouchStateSpace shows the body. Its node and displacement, or the place of a rigid
/// tool, are set each frame. Touching ends also when the device is pulled out.
#pragma once

#include <QString>
#include <memory>

#include "pqPalpateCutNow.h"
#include "pqPalpateRun.h"

namespace palpate
{
struct TouchSpace;
}
class pqOutputPort;
class pqRenderView;

class pqPalpateTouch : public pqPalpateRun
{
  Q_OBJECT
public:
  /// Figures of the loop and of the view, in words where they are not numbers.
  struct Figures : Pace
  {
    QString State;
    QString Contact;
    /// The force at the device, and that of the body, N.
    double Force = 0;
    double BodyForce = 0;
    /// The energy that the hand has put in, less what the body stores, J.
    double Dissipated = 0;
    /// The damping that takes away energy which the sampled loop has made, N·s/m.
    double Damping = 0;
    int Node = -1;
    int Branch = 0;
    QString Support;
    /// What the mesh does to the force of the body.
    palpate::TouchMeshError MeshError;
    /// Whether the space has the stages of a cut; then the area that is open, m², and what the hand
    /// has done, what the body stores and what tearing has taken, J.
    bool HasCut = false;
    double TornArea = 0;
    double HandWork = 0;
    double Stored = 0;
    double TornWork = 0;
    double FrictionWork = 0;
    /// How deep a rigid tool is in the body at rest, or how far the tool has moved its node, m;
    /// below 0: the tool touches nothing.
    double Depth = -1;
    /// How much deeper a rigid tool that presses can go, m; below 0: no rigid tool presses.
    double DepthLeft = -1;
    /// What is explored meanwhile; empty: nothing is.
    QString Explored;
  };

  explicit pqPalpateTouch(QObject* parent = nullptr);
  ~pqPalpateTouch() override;

  /// @param device The device, as in pqPalpateDevices.h.
  /// @param recording The file for the ticks, or, where there is such a file already, one that is
  ///   named after it; empty: none.
  /// @return Why it does not run; empty: it runs.
  QString start(
    pqOutputPort* space, pqRenderView* view, const QString& device, const QString& recording);
  Figures figures();
  /// What the tool does to the body at present.
  pqPalpateHeldTool heldTool() const;

protected:
  void tellLives() override;
  void advance() override;
  void takeNewData() override;
  QString endLoops(pqPalpateRun::Session& session) override;

private:
  struct Session;

  /// The session that runs.
  std::shared_ptr<Session> session() const;
  /// Shows another space from now on.
  void takeSpace(const palpate::TouchSpace& space);
  /// Shows what has changed since the last frame.
  void show();
  /// Sends the workspace and the other settings to the loop.
  void applySettings();
};
