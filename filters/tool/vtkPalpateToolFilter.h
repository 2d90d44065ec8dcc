// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateToolFilter
 * @brief what the filters have in common that touch a body with tools
 *
 * Inputs: a body with material and boundary (see vtkPalpateScene.h); the surface of the rigid tool,
 * where it is one.
 */
#pragma once

#include <vector>

#include "PalpateToolModule.h"
#include "vtkDataObjectAlgorithm.h"
#include "vtkPalpateTool.h"
#include "vtkSmartPointer.h"

class PALPATETOOL_EXPORT vtkPalpateToolFilter : public vtkDataObjectAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkPalpateToolFilter, vtkDataObjectAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Ids of the points of the input that tools are bonded to: on the surface and not fixed.
  void AddActiveNode(vtkIdType node);
  void ClearActiveNodes();
  ///@}
  ///@{
  /// The points of the connected patch of the surface within this distance of an active node move
  /// with it, m; 0: the node alone.
  vtkSetMacro(TipRadius, double);
  vtkGetMacro(TipRadius, double);
  ///@}
  ///@{
  /// The rigid tool; null: there is none.
  vtkSetSmartPointerMacro(Tool, vtkPalpateTool);
  vtkGetSmartPointerMacro(Tool, vtkPalpateTool);
  ///@}
  ///@{
  /// The field of gravity, m/s^2, which acts on a body with density.
  vtkSetVector3Macro(BodyForce, double);
  vtkGetVector3Macro(BodyForce, double);
  ///@}
  ///@{
  /// Time for one solve, or for a whole motion, s; 0 is no bound.
  vtkSetMacro(MaximumSeconds, double);
  vtkGetMacro(MaximumSeconds, double);
  ///@}
  ///@{
  /// Threads of a rank that solve for a large body without a factor, to 1024; 0: as many as there
  /// are cores for it.
  vtkSetMacro(Threads, int);
  vtkGetMacro(Threads, int);
  ///@}

  /// Later where its tool was changed, too.
  vtkMTimeType GetMTime() override;

protected:
  enum InputPort
  {
    BodyPort,
    SurfacePort,
    NumberOfInputs
  };

  vtkPalpateToolFilter();
  ~vtkPalpateToolFilter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override = 0;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override = 0;

  std::vector<vtkIdType> ActiveNodes;
  double TipRadius = 0;
  vtkSmartPointer<vtkPalpateTool> Tool;
  double BodyForce[3] = { 0, 0, 0 };
  double MaximumSeconds = 0;
  int Threads = 0;

private:
  vtkPalpateToolFilter(const vtkPalpateToolFilter&) = delete;
  void operator=(const vtkPalpateToolFilter&) = delete;
};
