// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateAssignMaterial
 * @brief says what a body of tetrahedra, or a region of it, is made of
 *
 * Adds cell arrays to the body (see vtkPalpateMaterials.h): `Law`, the parameters of the laws that
 * occur in it and, where it is not the one that suits them, `Formulation`. Cells outside the region
 * keep the material that they have; a cell that has none yet gets the Law -1. A parameter that the
 * law of a cell does not use is 0 there.
 */
#pragma once

#include <array>
#include <string>
#include <vector>

#include "PalpateFiltersModule.h"
#include "vtkUnstructuredGridAlgorithm.h"

namespace palpate
{
struct Material;
}

class PALPATEFILTERS_EXPORT vtkPalpateAssignMaterial : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateAssignMaterial* New();
  vtkTypeMacro(vtkPalpateAssignMaterial, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Number of a palpate::Law: 0 linear, 1 St. Venant-Kirchhoff, 2 neo-Hookean, 3 Mooney-Rivlin,
  /// 4 Mooney-Rivlin polynomial, 5 Fung, 6 neo-Hookean incompressible, 7 Mooney-Rivlin
  /// incompressible.
  vtkSetMacro(Law, int);
  vtkGetMacro(Law, int);
  ///@}
  ///@{
  /// Pa, positive. Laws 0 to 2, 5 and 6.
  vtkSetMacro(YoungsModulus, double);
  vtkGetMacro(YoungsModulus, double);
  ///@}
  ///@{
  /// Between -1 and 0.5, both excluded. Laws 0 to 2 and 5.
  vtkSetMacro(PoissonsRatio, double);
  vtkGetMacro(PoissonsRatio, double);
  ///@}
  ///@{
  /// Pa, not negative, not both 0. Laws 3 and 7.
  vtkSetMacro(C10, double);
  vtkGetMacro(C10, double);
  vtkSetMacro(C01, double);
  vtkGetMacro(C01, double);
  ///@}
  ///@{
  /// Pa, positive. Laws 3 and 4.
  vtkSetMacro(BulkModulus, double);
  vtkGetMacro(BulkModulus, double);
  ///@}
  ///@{
  /// How fast the material stiffens, positive. Law 5.
  vtkSetMacro(Exponent, double);
  vtkGetMacro(Exponent, double);
  ///@}
  ///@{
  /// C_rs, Pa, of the powers r and s with a sum of 1, 2 or 3; those that are not given are 0.
  /// Law 4.
  void AddCoefficient(double r, double s, double value);
  void ClearCoefficients();
  ///@}
  ///@{
  /// Number of a palpate::Formulation; -1: the one that suits the parameters.
  vtkSetMacro(Formulation, int);
  vtkGetMacro(Formulation, int);
  ///@}
  ///@{
  /// Cell array that tells the regions apart; "None" or empty: the material is for the whole body.
  vtkSetStdStringFromCharMacro(RegionArray);
  vtkGetCharFromStdStringMacro(RegionArray);
  ///@}
  ///@{
  /// Value of RegionArray in the cells that get the material.
  vtkSetMacro(RegionValue, double);
  vtkGetMacro(RegionValue, double);
  ///@}

protected:
  vtkPalpateAssignMaterial() = default;
  ~vtkPalpateAssignMaterial() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateAssignMaterial(const vtkPalpateAssignMaterial&) = delete;
  void operator=(const vtkPalpateAssignMaterial&) = delete;

  palpate::Material MakeMaterial() const;

  // Soft tissue, liver-like; the Mooney-Rivlin parameters have the same moduli at rest.
  int Law = 1;
  double YoungsModulus = 10000;
  double PoissonsRatio = 0.45;
  double C10 = 1293.1;
  double C01 = 431.03;
  double BulkModulus = 33333;
  double Exponent = 1;
  std::vector<std::array<double, 3>> Coefficients = { { 1, 0, 1293.1 }, { 0, 1, 431.03 } };
  int Formulation = -1;
  std::string RegionArray = "None";
  double RegionValue = 0;
};
