// SPDX-License-Identifier: BSD-3-Clause
// A surface by which a body is shown in place of its own: a fine one of the same organ, with
// colours, texture and whatever else it has. The surface of the body carries it
// (mesh/surface_embedding.h). Where the body is cut it is split, so that it opens
// (state_space/split_surface.h), and what is within the cut are the sides of the body's own.
#pragma once

#include <functional>
#include <memory>

#include "base/types.h"
#include "state_space/surface.h"
#include "vtkType.h"

namespace palpate
{
class Communicator;
}
class vtkInformationVector;
class vtkMultiProcessController;
class vtkObject;
class vtkPolyData;

class vtkPalpateDisplaySurface
{
public:
  struct Carrier
  {
    /// The surface of a body as it was meshed.
    palpate::Surface Surface;
    /// The displacement from there from which `Displacement` counts [3 points], m: that of a body
    /// that sags. Empty: it is 0.
    Eigen::VectorXf Settled;
  };

  vtkPalpateDisplaySurface();
  ~vtkPalpateDisplaySurface();

  /// Takes the surface of an optional input, if it or the carrier is another one than before.
  /// @param filter Warns of points that are off the body.
  /// @param port The input, where there may be nothing.
  /// @param carrierTime When the body was made.
  /// @param carrier Called on rank 0.
  /// @throws palpate::InputError the surface has no triangle or does not lie on the body.
  /// @note Collective.
  void Take(vtkObject* filter, vtkInformationVector* port, vtkMTimeType carrierTime,
    vtkMultiProcessController* controller, palpate::Communicator& ranks,
    const std::function<Carrier()>& carrier);

  /// Whether there is a surface, on this rank.
  [[nodiscard]] bool IsGiven() const;

  /// Puts the surface in the place of that of the body.
  /// @param body The carrier, with the point array `Displacement` (m). It becomes the surface as it
  ///   is displaced, with `Displacement` and normals, its own arrays, and those of the body,
  ///   interpolated; field data stay.
  void Follow(vtkPolyData* body) const;

private:
  struct Embedded;
  std::unique_ptr<Embedded> Surface;
  vtkMTimeType CarrierTime = 0;
  vtkMTimeType SurfaceTime = 0;
};
