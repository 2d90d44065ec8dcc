// SPDX-License-Identifier: BSD-3-Clause
// Reads numbers, ids and names in FEBio's file. A text that is none of them is an error, whose
// message says where it is.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <unordered_map>
#include <vector>

#include "vtkPalpateXMLTree.h"

namespace vtkPalpateFEBio
{
using Tree = vtkPalpateXMLTree;

/// The id of a node or an element in the file: any number, each once.
using Id = std::int64_t;

/// The name of an element of the file, for a message.
std::string Label(const Tree& element);

/// The value of an attribute. @throws palpate::InputError the element has none of that name.
std::string Attribute(const Tree& element, const char* name);

/// The children of an element; none if there is no such element.
const std::vector<Tree>& ChildrenOf(const Tree* element);

/// The numbers of a text that are separated by commas, with nothing else in it.
/// @tparam Number double or Id.
/// @throws palpate::InputError one is none.
template <class Number>
void AppendNumbers(const std::string& text, const Tree& element, std::vector<Number>& numbers);

/// @throws palpate::InputError the text is not one number.
double NumberOf(const std::string& text, const Tree& element);

/// @throws palpate::InputError the attribute is missing, or not one id.
Id IdOf(const Tree& element, const char* attribute = "id");

/// The children of an element by the value of an attribute, so that each reference to a child is
/// found fast. The element must outlive this object.
class ChildIndex
{
public:
  /// @param parent Null: there is none.
  explicit ChildIndex(const Tree* parent, const char* attribute = "name");

  /// The children with a value, in their order; null: there is none.
  const std::vector<const Tree*>* Find(const std::string& value) const;
  /// The first child with a value that is one of several elements; null: there is none.
  const Tree* First(const std::string& value, std::initializer_list<const char*> elements) const;

private:
  std::unordered_map<std::string, std::vector<const Tree*>> Children;
};

/// The ids that the mesh has.
struct KnownIds
{
  /// The ids in ascending order, each once.
  std::vector<Id> Ids;
  /// The name of the things that have the ids: "node" or "element".
  std::string What;
};

/// The ids of a set: those of the children (2.5, 3.0), or a list (4.0), in which first:last and
/// first:last:step are ranges. The mesh must have each of them, and no set may name more than the
/// mesh has, so that a short text cannot ask for more memory than its mesh takes.
/// @throws palpate::InputError an id is not valid, the mesh does not have it, or there are too
///   many.
std::vector<Id> IdsOf(const Tree& set, const KnownIds& known);

/// The ids of a part or of a set of elements. @param where The element of the file that names it.
/// @param sets The sets of the mesh.
/// @throws palpate::InputError there is none of that name, or as IdsOf().
std::vector<Id> ElementsOf(
  const ChildIndex& sets, const std::string& name, const Tree& where, const KnownIds& known);

bool StartsWith(const std::string& text, const char* start);
}
