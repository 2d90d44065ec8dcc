// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateTool
 * @brief a rigid tool that presses a body without friction, by its properties
 *
 * A subclass has the properties of one kind of shape. A palpate::ShapeKind gives a meaning to the
 * numbers in which they are stored. The motion of the tool, and the layer in which it presses, are
 * properties of all shapes.
 */
#pragma once

#include <memory>

#include "PalpateToolModule.h"
#include "vtkObject.h"
#include "vtkSmartPointer.h"

class vtkPalpateMotion;
class vtkPolyData;

namespace palpate
{
class MotionKind;
class ShapeKind;
struct RigidTool;
}

class PALPATETOOL_EXPORT vtkPalpateTool : public vtkObject
{
public:
  vtkTypeMacro(vtkPalpateTool, vtkObject);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The thickness of the layer in which contact acts, m; 0: a fifth of the radius of the tool, or
  /// of half of its smallest extent.
  vtkSetMacro(ContactThickness, double);
  vtkGetMacro(ContactThickness, double);
  ///@}
  ///@{
  /// The pressure at the inner side of that layer, Pa; 0: see palpate::with_defaults().
  vtkSetMacro(ContactStiffness, double);
  vtkGetMacro(ContactStiffness, double);
  ///@}
  ///@{
  /// How the tool is moved; null: translated.
  void SetMotion(vtkPalpateMotion* motion);
  vtkPalpateMotion* GetMotion();
  ///@}

  /// The time of the last change of the tool or of its motion.
  vtkMTimeType GetMTime() override;

  /// Whether the tool has the shape of the surface that is connected to a filter.
  virtual bool HasShapeOfSurface() const { return false; }
  /// Returns the tool in numbers. A thickness or stiffness of 0 is not replaced here, see
  /// palpate::with_defaults().
  /// @param surface The surface that is connected to the filter; null if it is not needed or
  ///   missing.
  /// @throws palpate::InputError the surface is needed but missing, or is not valid.
  palpate::RigidTool Describe(vtkPolyData* surface) const;

  ///@{
  /// Adds a kind of shape or motion that a plugin of its own brings, see palpate::add_shape_kind()
  /// and palpate::add_motion_kind().
  static void AddKind(std::unique_ptr<const palpate::ShapeKind> kind);
  static void AddKind(std::unique_ptr<const palpate::MotionKind> kind);
  ///@}

protected:
  vtkPalpateTool();
  ~vtkPalpateTool() override;

  /// Gives the tool its shape.
  virtual void DescribeShape(vtkPolyData* surface, palpate::RigidTool& tool) const = 0;

private:
  vtkPalpateTool(const vtkPalpateTool&) = delete;
  void operator=(const vtkPalpateTool&) = delete;

  double ContactThickness = 0;
  double ContactStiffness = 0;
  vtkSmartPointer<vtkPalpateMotion> Motion;
};
