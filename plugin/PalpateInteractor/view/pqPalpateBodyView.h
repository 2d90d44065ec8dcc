// SPDX-License-Identifier: BSD-3-Clause
/// The touched body in ParaView's view. A filter on the server, wherever that is, shows it:
/// TouchStateSpace with the node or the rigid tool at a place, or TouchReducedModel with a reduced
/// body. Other filters can take its output.
///
/// Where the machine does not draw fast enough, two things are left out while one touches: edges
/// are not smoothed (without graphics hardware that takes more than half of the time of a frame),
/// and the inner side of an opaque body, which nobody sees, is not drawn.
#pragma once

#include <QElapsedTimer>
#include <QPointer>
#include <string>
#include <vector>

#include "pqPalpateRunWatch.h"
#include "vtkSMProxy.h"
#include "vtkWeakPointer.h"

class pqOutputPort;
class pqPipelineSource;
class pqRenderView;
class vtkSMPVRepresentationProxy;

class pqPalpateBodyView
{
public:
  /// Shows the body at rest in the place of its state space. Makes the filter where there is none.
  /// @param colouredBy A point array of the filter, and the largest value that is coloured.
  /// @param inTissue As for SetColours(). It has an effect on a filter that was made here, unless a
  ///   person has coloured it since.
  /// @param free A place where a rigid tool touches nothing [3], m.
  /// @throws std::runtime_error the server does not have the filter.
  pqPalpateBodyView(pqOutputPort* space, pqRenderView* view, const char* colouredBy, double most,
    bool inTissue, const double* free);

  /// Shows a reduced body at rest.
  /// @param model The body with its reduced model.
  /// @param most The largest displacement that is coloured, m.
  pqPalpateBodyView(pqOutputPort* model, pqRenderView* view, double most, bool inTissue);

  /// @param inTissue Whether the body at rest has the colour of tissue; otherwise the colour map is
  ///   ParaView's own.
  void SetColours(bool inTissue);

  pqPipelineSource* GetFilter() const { return this->Filter; }

  /// @param node The active node; -1: the first of the space.
  /// @param body The body of the space on which the node is.
  /// @param branch The branch that the body is on there.
  /// @param displacement The displacement of the node [3], m.
  void Show(int node, vtkIdType body, int branch, const double* displacement, double tornArea);
  /// @param place The place of the rigid tool [3], m.
  /// @param branch The branch that the body is on there.
  /// @param grew Whether more of the space is known, so that the same place may look different.
  void ShowPressed(const double* place, int branch, bool grew);
  /// @param coordinates All coordinates of the reduced body; none: the body is at rest.
  /// @param number The number of coordinates.
  void ShowReduced(const double* coordinates, unsigned int number);
  /// Call this at the end. It restores the picture of the view and shows the body at rest, as far
  /// as these are still there.
  void Leave(pqPalpateRunWatch::Left left);
  void ShowRest();
  /// Draws the view.
  void Draw();
  /// Says that there is nothing to draw now, so that the next frame does not count as late.
  void Rest() { this->LastFrame = -1; }
  quint64 GetNumberOfFrames() const { return this->NumberOfFrames; }
  /// The number of frames in the last second.
  double GetFrameRate();

private:
  /// Draws again what was left out.
  void RestorePicture();
  void SetRest();
  /// Whether all that is shown is up to date.
  bool IsKnown() const;
  /// Sends the changed properties of the filter.
  /// @param isKnown Whether all was up to date before.
  void Take(vtkSMProxy* filter, bool isKnown);
  /// Keeps ParaView from asking again, for each property of each representation, which arrays there
  /// are: only the points of the body have moved. The questions would take longer than drawing.
  void KeepDomains();
  /// Leaves out, when frames come too late, what costs most and is seen least.
  void KeepPace();
  void LeaveOut(vtkSMProxy* proxy, const char* property, int value);

  /// @param filter The name of the filter that shows the body.
  pqPalpateBodyView(pqOutputPort* space, pqRenderView* view, const char* filter,
    const char* colouredBy, double most, bool inTissue, const double* free);
  /// Makes the legend of the colours, in letters that are legible whatever is behind it.
  void SetLegend();
  /// The representation of the filter in the view; null: the filter is not shown.
  vtkSMPVRepresentationProxy* FindShown() const;

  /// A place where a rigid tool touches nothing, m. A reduced body has none.
  double Free[3] = { 0, 0, 0 };
  bool IsReduced;
  std::string ColouredBy;
  double Most;
  QPointer<pqPipelineSource> Filter;
  QPointer<pqRenderView> View;
  struct Omission
  {
    vtkWeakPointer<vtkSMProxy> Proxy;
    const char* Property;
    int Before;
  };
  std::vector<Omission> Omissions;
  QElapsedTimer Time;
  /// The times of the last frames, ms.
  std::vector<qint64> Frames;
  quint64 NumberOfFrames = 0;
  qint64 LastFrame = -1;
  int LateFrames = 0;
  bool IsOver = false;
};
