// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateToolPath.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkTable.h"

namespace
{
using palpate::InputError;

constexpr const char* Time = "Time";

std::string ColumnOfTool(int tool, int axis)
{
  return "Tool" + std::to_string(tool) + '_' + "XYZ"[axis];
}

std::vector<double> Column(vtkTable* table, const std::string& name)
{
  vtkAbstractArray* column = table->GetColumnByName(name.c_str());
  if (!column)
  {
    std::string names;
    for (vtkIdType i = 0; i < table->GetNumberOfColumns(); ++i)
    {
      const char* other = table->GetColumnName(i);
      names += std::string(i == 0 ? "" : ", ") + (other ? other : "one without a name");
    }
    throw InputError("The table of the tools has no column " + name +
      ". It needs Time (s), and for each tool three columns, Tool0_X, Tool0_Y, Tool0_Z (m), then "
      "Tool1_X, …; it has: " +
      names + '.');
  }
  auto* numbers = vtkDataArray::SafeDownCast(column);
  if (!numbers || numbers->GetNumberOfComponents() != 1)
  {
    throw InputError("The column " + name +
      " of the table of the tools has text, or several numbers in a row. Give it one number in "
      "each row.");
  }
  // A script can make columns of different lengths.
  if (numbers->GetNumberOfTuples() != table->GetNumberOfRows())
  {
    throw InputError("The column " + name + " of the table of the tools has " +
      std::to_string(numbers->GetNumberOfTuples()) + " rows, and the table has " +
      std::to_string(table->GetNumberOfRows()) + ". Give each column a number in each row.");
  }
  std::vector<double> values;
  for (vtkIdType row = 0; row < numbers->GetNumberOfTuples(); ++row)
  {
    values.push_back(numbers->GetComponent(row, 0));
  }
  return values;
}

/// Lets a tool go at the time that its column of the table says.
void LetGo(vtkTable* table, int tool, const std::vector<double>& times, palpate::ToolPath& path)
{
  const std::string name = "Tool" + std::to_string(tool) + "_Held";
  if (!table->GetColumnByName(name.c_str()))
  {
    return;
  }
  const std::vector<double> held = Column(table, name);
  bool isHeld = true;
  for (std::size_t row = 0; row < held.size(); ++row)
  {
    if (held[row] != 0 && (held[row] != 1 || !isHeld))
    {
      throw InputError("Row " + std::to_string(row) + " of the column " + name +
        " of the table of the tools is " + (isHeld ? "neither 0 nor 1" : "not 0 after a 0") +
        ". Give 1 as long as the tool is held and 0 from where it is let go; it is not held "
        "again.");
    }
    if (isHeld && held[row] == 0)
    {
      path.let_go(tool, times[row]);
      isHeld = false;
    }
  }
}
}

int vtkPalpateCountTools(vtkTable* table)
{
  int number = 0;
  const auto has = [&](int tool)
  {
    bool any = false;
    for (int axis = 0; table && axis < 3; ++axis)
    {
      any = any || table->GetColumnByName(ColumnOfTool(tool, axis).c_str());
    }
    return any;
  };
  while (has(number))
  {
    ++number;
  }
  return number;
}

palpate::ToolPath vtkPalpateToolPath(vtkTable* table)
{
  const std::vector<double> times = Column(table, Time);
  const int tools = vtkPalpateCountTools(table);
  Eigen::MatrixXd coordinates(3 * tools, static_cast<Eigen::Index>(times.size()));
  for (int tool = 0; tool < tools; ++tool)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      const std::vector<double> values = Column(table, ColumnOfTool(tool, axis));
      coordinates.row(3 * tool + axis) = Eigen::Map<const Eigen::RowVectorXd>(
        values.data(), static_cast<Eigen::Index>(values.size()));
    }
  }
  palpate::ToolPath path(times, std::move(coordinates));
  for (int tool = 0; tool < tools; ++tool)
  {
    LetGo(table, tool, times, path);
  }
  return path;
}
