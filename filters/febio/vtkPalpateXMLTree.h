// SPDX-License-Identifier: BSD-3-Clause
// An XML file as a tree, parsed by VTK (vtkXMLParser, which is Expat). A tree of vtkXMLDataElement
// takes ten times the memory, 2.5 KB for each node of a mesh.
#pragma once

#include <string>
#include <utility>
#include <vector>

struct vtkPalpateXMLTree
{
  std::string Name;
  std::vector<std::pair<std::string, std::string>> Attributes;
  /// The text between its tags besides the children, without white space at the ends.
  std::string Text;
  std::vector<vtkPalpateXMLTree> Children;

  /// The value of an attribute, or null.
  const std::string* Attribute(const char* name) const;
  /// The first child of that name, or null.
  const vtkPalpateXMLTree* Child(const char* name) const;
};

/// The root of the file.
/// @throws palpate::InputError there is no such file, or it is no XML: the message says what is
///   wrong, and where.
vtkPalpateXMLTree vtkPalpateReadXML(const std::string& fileName);
