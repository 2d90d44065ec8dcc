// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateExactPredicates.h"

#include <cmath>
#include <limits>
#include <vector>

namespace
{
constexpr double Epsilon = std::numeric_limits<double>::epsilon() / 2; // half an ulp of 1
constexpr double Bound3D = (7 + 56 * Epsilon) * Epsilon;
constexpr double Bound2D = (3 + 16 * Epsilon) * Epsilon;

/// A number as a sum of doubles that do not overlap, smallest first, without zeros.
using Expansion = std::vector<double>;

void Add(Expansion& sum, double term)
{
  std::size_t kept = 0;
  for (const double part : sum)
  {
    const double total = term + part;
    const double virtual_part = total - term;
    const double error = (term - (total - virtual_part)) + (part - virtual_part);
    if (error != 0)
    {
      sum[kept++] = error;
    }
    term = total;
  }
  sum.resize(kept);
  if (term != 0)
  {
    sum.push_back(term);
  }
}

Expansion Difference(double a, double b)
{
  Expansion result;
  Add(result, a);
  Add(result, -b);
  return result;
}

Expansion Difference(Expansion a, const Expansion& b)
{
  for (const double part : b)
  {
    Add(a, -part);
  }
  return a;
}

Expansion Product(const Expansion& a, const Expansion& b)
{
  Expansion result;
  for (const double x : a)
  {
    for (const double y : b)
    {
      const double product = x * y;
      Add(result, std::fma(x, y, -product));
      Add(result, product);
    }
  }
  return result;
}

int Sign(double value)
{
  return (value > 0) - (value < 0);
}

int Sign(const Expansion& value)
{
  return value.empty() ? 0 : Sign(value.back());
}
}

int vtkPalpateOrient3D(const vtkPalpatePoint& a, const vtkPalpatePoint& b, const vtkPalpatePoint& c,
  const vtkPalpatePoint& d)
{
  const double ax = a[0] - d[0], ay = a[1] - d[1], az = a[2] - d[2];
  const double bx = b[0] - d[0], by = b[1] - d[1], bz = b[2] - d[2];
  const double cx = c[0] - d[0], cy = c[1] - d[1], cz = c[2] - d[2];
  const double determinant =
    az * (bx * cy - cx * by) + bz * (cx * ay - ax * cy) + cz * (ax * by - bx * ay);
  const double permanent = (std::abs(bx * cy) + std::abs(cx * by)) * std::abs(az) +
    (std::abs(cx * ay) + std::abs(ax * cy)) * std::abs(bz) +
    (std::abs(ax * by) + std::abs(bx * ay)) * std::abs(cz);
  if (std::abs(determinant) > Bound3D * permanent)
  {
    return Sign(determinant);
  }

  std::array<Expansion, 3> u, v, w;
  for (int i = 0; i < 3; ++i)
  {
    u[i] = Difference(a[i], d[i]);
    v[i] = Difference(b[i], d[i]);
    w[i] = Difference(c[i], d[i]);
  }
  const auto minor = [](const std::array<Expansion, 3>& p, const std::array<Expansion, 3>& q)
  { return Difference(Product(p[0], q[1]), Product(q[0], p[1])); };
  Expansion exact = Product(u[2], minor(v, w));
  for (const double part : Product(v[2], minor(w, u)))
  {
    Add(exact, part);
  }
  for (const double part : Product(w[2], minor(u, v)))
  {
    Add(exact, part);
  }
  return Sign(exact);
}

int vtkPalpateOrient2D(
  const vtkPalpatePoint& a, const vtkPalpatePoint& b, const vtkPalpatePoint& c, int axis)
{
  const int x = (axis + 1) % 3;
  const int y = (axis + 2) % 3;
  const double left = (a[x] - c[x]) * (b[y] - c[y]);
  const double right = (a[y] - c[y]) * (b[x] - c[x]);
  const double determinant = left - right;
  if (std::abs(determinant) > Bound2D * (std::abs(left) + std::abs(right)))
  {
    return Sign(determinant);
  }
  return Sign(Difference(Product(Difference(a[x], c[x]), Difference(b[y], c[y])),
    Product(Difference(a[y], c[y]), Difference(b[x], c[x]))));
}
