# SPDX-License-Identifier: BSD-3-Clause
"""Rows of figures as a vtkTable, a CSV file and a table in Markdown."""
import os

from paraview.simple import *
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkTable
from vtkmodules.vtkIOCore import vtkDelimitedTextWriter

from pipeline import Failure

OUTCOMES = ("converged", "not converged", "not factorised", "budget used up", "aborted",
            "refused", "not solved without a factor")
FLAGS = {1: "inverted", 2: "unstable", 4: "beyond the force limit", 8: "near a fold",
         16: "inertia not computed", 32: "inaccurate",
         64: "touches nothing"}


def flag_names(flags):
    return ", ".join(name for bit, name in FLAGS.items() if flags & bit)


def vtk_table(rows, columns):
    """Of dictionaries; a column is of text or of numbers, and None is an empty text or NaN."""
    table = vtkTable()
    for column in columns:
        values = [row.get(column) for row in rows]
        text = any(isinstance(value, str) for value in values)
        array = vtkStringArray() if text else vtkDoubleArray()
        array.SetName(column)
        for value in values:
            if text:
                array.InsertNextValue("" if value is None else str(value))
            else:
                array.InsertNextValue(float("nan") if value is None else float(value))
        table.AddColumn(array)
    return table


def save_csv(table, path):
    writer = vtkDelimitedTextWriter()
    writer.SetInputData(table)
    writer.SetFileName(path)
    writer.SetFieldDelimiter(",")
    if not writer.Write():
        raise Failure(f"cannot write {path}.")


def markdown(rows, columns):
    """`columns`: name of the column to how a number in it is written, such as '.3g'."""
    def cell(value, form):
        if value is None or value != value:
            return ""
        return value if isinstance(value, str) else format(value, form)

    lines = ["| " + " | ".join(columns) + " |",
             "|" + "|".join("---" if form == "s" else "---:" for form in columns.values()) + "|"]
    for row in rows:
        lines.append("| " + " | ".join(cell(row.get(name), form)
                                       for name, form in columns.items()) + " |")
    return "\n".join(lines)


def save_table(rows, columns, remarks, folder, summary=""):
    """Writes table.csv and table.md, which has the summary above its rows and the remarks below,
    and prints the latter. `columns` as those of markdown()."""
    save_csv(vtk_table(rows, columns), os.path.join(folder, "table.csv"))
    text = f"{summary}\n\n" * bool(summary) + markdown(rows, columns)
    if remarks:
        text += "\n\n" + "\n".join(f"- {remark}" for remark in remarks)
    with open(os.path.join(folder, "table.md"), "w", encoding="utf-8") as file:
        file.write(text + "\n")
    print(text, flush=True)
