// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkPalpateTetrahedralize
 * @brief   what the filters that fill something with tetrahedra have in common
 *
 * Output port 0: the tetrahedra, positively oriented, with straight edges, in m. Port 1: a surface
 * that says more, see the filters.
 */
#pragma once

#include <string>

#include "PalpateMeshingModule.h"
#include "vtkImplicitFunction.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkMultiProcessController;
struct vtkPalpateEdges;

class PALPATEMESHING_EXPORT vtkPalpateTetrahedralize : public vtkUnstructuredGridAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkPalpateTetrahedralize, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Number of a vtkPalpateUnit: the unit of the lengths of the input. All lengths and volumes of
  /// the properties are in m, and so is the body.
  vtkSetMacro(Unit, int);
  vtkGetMacro(Unit, int);
  ///@}

  enum ElementOrders
  {
    Linear = 1,   ///< VTK_TETRA
    Quadratic = 2 ///< VTK_QUADRATIC_TETRA, with points in the middle of straight edges
  };
  vtkSetMacro(ElementOrder, int);
  vtkGetMacro(ElementOrder, int);

  ///@{ Largest ratio of circumscribed radius to shortest edge, ≥ 1; the less, the better shaped.
  vtkSetMacro(MaximumRadiusEdgeRatio, double);
  vtkGetMacro(MaximumRadiusEdgeRatio, double);
  ///@}

  ///@{ Where the mesh shall be finer: where the function is negative.
  virtual void SetRefineRegion(vtkImplicitFunction* function);
  vtkImplicitFunction* GetRefineRegion() const;
  ///@}

  ///@{
  /// The longest edge of a tetrahedron in RefineRegion, m; beyond it edges may be longer by
  /// EdgeGrowth in a metre. 0: as elsewhere.
  vtkSetMacro(RefineEdge, double);
  vtkGetMacro(RefineEdge, double);
  vtkSetMacro(EdgeGrowth, double);
  vtkGetMacro(EdgeGrowth, double);
  ///@}

  vtkMTimeType GetMTime() override;

  ///@{ TetGen is stopped after this time, s; 0 = never.
  vtkSetMacro(TimeOut, double);
  vtkGetMacro(TimeOut, double);
  ///@}

  ///@{ The ranks; by default those of the global controller, which may be none.
  virtual void SetController(vtkMultiProcessController* controller);
  vtkMultiProcessController* GetController() const;
  ///@}

  ///@{
  /// The expected cost of the filter, by its properties and its present input.
  /// @note Collective.
  void UpdateEstimate();
  vtkGetCharFromStdStringMacro(Estimate);
  ///@}

protected:
  vtkPalpateTetrahedralize();
  ~vtkPalpateTetrahedralize() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;

  /// The largest number of tetrahedra. Whoever asks for more has most likely chosen a wrong unit.
  static constexpr double MostTetrahedra = 2e7;

  /// Thrown when the user has asked for an abort.
  struct Aborted
  {
  };

  /// Whether RefineRegion has an effect.
  [[nodiscard]] virtual bool UsesRefineRegion() const { return this->RefineEdge > 0; }
  /// What RefineEdge asks for.
  [[nodiscard]] vtkPalpateEdges AskedEdges() const;
  /// About how many tetrahedra that takes.
  /// @param volume That of RefineRegion in the body, m³.
  [[nodiscard]] double TetrahedraOfEdge(double volume) const;
  /// The text for UpdateEstimate(), on every rank.
  virtual std::string MakeEstimate() = 0;
  /// Checks the properties.
  /// @throws palpate::InputError a property is out of its range: the message names it.
  virtual void Validate() const;
  /// @throws palpate::InputError "<name> is <value>, but must be <range>."
  static void Require(bool holds, const std::string& name, double value, const char* range);
  /// @throws Aborted
  void Progress(double fraction);

  vtkSmartPointer<vtkImplicitFunction> RefineRegion;
  double RefineEdge = 0;
  double EdgeGrowth = 0.4;
  int Unit = 0;
  int ElementOrder = Linear;
  double MaximumRadiusEdgeRatio = 1.414;
  double TimeOut = 600;
  vtkSmartPointer<vtkMultiProcessController> Controller;
  std::string Estimate;

private:
  vtkPalpateTetrahedralize(const vtkPalpateTetrahedralize&) = delete;
  void operator=(const vtkPalpateTetrahedralize&) = delete;
};
