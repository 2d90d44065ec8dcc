// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateAssignMaterial
 * @brief says what a body of tetrahedra, or a region of it, is made of
 *
 * Adds cell arrays to the body (see vtkPalpateMaterials.h): `Law`, the parameters of the laws that
 * occur in it and, where it is not the one that suits them, `Formulation`. Cells outside the region
 * keep the material that they have; a cell that has none yet gets the Law -1. A parameter that the
 * law of a cell does not use is 0 there.
 *
 * Density and viscosity make cell arrays too (`Density`, `ViscousTime`, `PronyModulus1`,
 * `PronyTime1`, …), where any of them is given; else those that are there stay as they are.
 *
 * The second input is the surface of a region, where RegionType says so.
 */
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "PalpateSceneModule.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkImplicitFunction;
class vtkPolyData;

namespace palpate
{
struct Material;
struct Rheology;
}

class PALPATESCENE_EXPORT vtkPalpateAssignMaterial : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateAssignMaterial* New();
  vtkTypeMacro(vtkPalpateAssignMaterial, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// Number of a palpate::Law: 0 linear, 1 St. Venant-Kirchhoff, 2 neo-Hookean, 3 Mooney-Rivlin,
  /// 4 Mooney-Rivlin polynomial, 5 Fung, 6 neo-Hookean incompressible, 7 Mooney-Rivlin
  /// incompressible, 8 Ogden; or, from 100 on, of one of palpate::tissues(), which has parameters
  /// of its own.
  vtkSetMacro(Law, int);
  vtkGetMacro(Law, int);
  ///@}
  ///@{
  /// Young's modulus, Pa, positive. For laws 0 to 2, 5 and 6.
  vtkSetMacro(YoungsModulus, double);
  vtkGetMacro(YoungsModulus, double);
  ///@}
  ///@{
  /// Poisson's ratio, between -1 and 0.5, both excluded. For laws 0 to 2 and 5.
  vtkSetMacro(PoissonsRatio, double);
  vtkGetMacro(PoissonsRatio, double);
  ///@}
  ///@{
  /// C₁₀ and C₀₁, Pa, not negative, not both 0. For laws 3 and 7.
  vtkSetMacro(C10, double);
  vtkGetMacro(C10, double);
  vtkSetMacro(C01, double);
  vtkGetMacro(C01, double);
  ///@}
  ///@{
  /// The bulk modulus, Pa, positive. For laws 3, 4 and 8.
  vtkSetMacro(BulkModulus, double);
  vtkGetMacro(BulkModulus, double);
  ///@}
  ///@{
  /// The exponent, which says how fast the material stiffens, positive. For law 5.
  vtkSetMacro(Exponent, double);
  vtkGetMacro(Exponent, double);
  ///@}
  ///@{
  /// C_rs, Pa, for the powers r and s with a sum of 1, 2 or 3; coefficients that are not given are
  /// 0. For law 4.
  void AddCoefficient(double r, double s, double value);
  void ClearCoefficients();
  ///@}
  ///@{
  /// The μ_i (Pa) and α_i of the terms; both are 0 for a term that is not used. For law 8.
  vtkSetVector3Macro(OgdenModuli, double);
  vtkGetVector3Macro(OgdenModuli, double);
  vtkSetVector3Macro(OgdenExponents, double);
  vtkGetVector3Macro(OgdenExponents, double);
  ///@}
  ///@{
  /// Number of a palpate::Formulation; -1: the one that suits the parameters.
  vtkSetMacro(Formulation, int);
  vtkGetMacro(Formulation, int);
  ///@}
  ///@{
  /// The quadrature of quadratic cells that are mixed: 0 the standard rule, 1 a fine one
  /// (Formulation::mixed_fine).
  vtkSetMacro(Quadrature, int);
  vtkGetMacro(Quadrature, int);
  ///@}
  ///@{
  /// The density, kg/m^3, not negative.
  vtkSetMacro(Density, double);
  vtkGetMacro(Density, double);
  ///@}
  ///@{
  /// The time of the Kelvin-Voigt viscosity, s, not negative.
  vtkSetMacro(ViscousTime, double);
  vtkGetMacro(ViscousTime, double);
  ///@}
  ///@{
  /// The terms of a Prony series, as many as palpate::max_prony_terms at the most: their moduli in
  /// long-term ones of the law, without unit, and their times, s, ascending.
  void AddPronyModulus(double modulus);
  void ClearPronyModuli();
  void AddPronyTime(double time);
  void ClearPronyTimes();
  ///@}
  enum RegionTypes
  {
    Array = 0,   ///< RegionArray and RegionValue
    Shape = 1,   ///< RegionShape
    Surface = 2, ///< the second input
    Table = 3    ///< Regions: a material for each of several values of RegionArray
  };
  ///@{
  /// Says how the cells that get the material are chosen.
  vtkSetMacro(RegionType, int);
  vtkGetMacro(RegionType, int);
  ///@}
  ///@{
  /// Cell array that tells the regions apart; "None" or empty: the material is for the whole body.
  vtkSetStdStringFromCharMacro(RegionArray);
  vtkGetCharFromStdStringMacro(RegionArray);
  ///@}
  ///@{
  /// The value of RegionArray in the cells that get the material.
  vtkSetMacro(RegionValue, double);
  vtkGetMacro(RegionValue, double);
  ///@}
  ///@{
  /// The material of one of several regions, in place of that of Law.
  /// @param value Of RegionArray. @param law By name, or the name of a tissue. @param parameters
  /// Names and values by turns, separated by spaces: "YoungsModulus 5000 PoissonsRatio 0.45". A
  /// region that names none of palpate::rheology_names() has the density and viscosity of the
  /// properties.
  void AddRegion(const char* value, const char* law, const char* parameters);
  void ClearRegions();
  ///@}
  ///@{
  /// The cells at whose middle the function is not positive get the material.
  virtual void SetRegionShape(vtkImplicitFunction* shape);
  vtkImplicitFunction* GetRegionShape() const;
  ///@}

  ///@{
  /// The names that AddRegion accepts: those of the laws, then those of the tissues. Also the
  /// parameters of soft tissue for a law; a tissue needs none.
  static std::vector<std::string> LawNames();
  static std::string ParametersOfLaw(const std::string& name);
  ///@}

  vtkMTimeType GetMTime() override;

protected:
  vtkPalpateAssignMaterial();
  ~vtkPalpateAssignMaterial() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateAssignMaterial(const vtkPalpateAssignMaterial&) = delete;
  void operator=(const vtkPalpateAssignMaterial&) = delete;

  /// The material of a region.
  struct Assignment;

  palpate::Material MakeMaterial() const;
  /// The material with Formulation and Quadrature.
  palpate::Material InItsFormulation(const palpate::Material& material) const;
  /// The rheology of the properties; nothing if none of them is given.
  std::optional<palpate::Rheology> MakeRheology() const;
  std::vector<char> ChooseCells(vtkUnstructuredGrid* body, vtkPolyData* surface) const;
  std::vector<Assignment> Assignments(vtkUnstructuredGrid* body, vtkPolyData* surface) const;

  // Soft tissue, liver-like; the Mooney-Rivlin parameters have the same moduli at rest.
  int Law = 1;
  double YoungsModulus = 10000;
  double PoissonsRatio = 0.45;
  double C10 = 1293.1;
  double C01 = 431.03;
  double BulkModulus = 33333;
  double Exponent = 1;
  std::vector<std::array<double, 3>> Coefficients = { { 1, 0, 1293.1 }, { 0, 1, 431.03 } };
  double OgdenModuli[3] = { 3448.3, 0, 0 };
  double OgdenExponents[3] = { 2, 0, 0 };
  int Formulation = -1;
  int Quadrature = 0;
  double Density = 0;
  double ViscousTime = 0;
  std::vector<double> PronyModuli;
  std::vector<double> PronyTimes;
  int RegionType = Array;
  std::string RegionArray = "None";
  double RegionValue = 0;
  vtkSmartPointer<vtkImplicitFunction> RegionShape;
  std::vector<std::array<std::string, 3>> Regions;
};
