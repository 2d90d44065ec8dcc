// SPDX-License-Identifier: BSD-3-Clause
// Numbers, ids and names in FEBio's file. What is none is an error that says where it stands.
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

/// Of a node or an element in the file: any number, each once.
using Id = std::int64_t;

/// How an element of the file is called in a message.
std::string Label(const Tree& element);

/// @throws palpate::InputError it has none of that name.
std::string Attribute(const Tree& element, const char* name);

/// None where there is no such element.
const std::vector<Tree>& ChildrenOf(const Tree* element);

/// The numbers of a text with commas between them, each of which is a number and nothing else.
/// @tparam Number double or Id.
/// @throws palpate::InputError one is none.
template <class Number>
void AppendNumbers(const std::string& text, const Tree& element, std::vector<Number>& numbers);

/// @throws palpate::InputError the text is not one number.
double NumberOf(const std::string& text, const Tree& element);

/// @throws palpate::InputError the attribute is missing, or not one id.
Id IdOf(const Tree& element, const char* attribute = "id");

/// The children of an element by an attribute, so that as many references to them as there are
/// take no longer than to read them. The element has to stay.
class ChildIndex
{
public:
  /// @param parent Null: there is none.
  explicit ChildIndex(const Tree* parent, const char* attribute = "name");

  /// Those of a value, in their order; null: there is none.
  const std::vector<const Tree*>* Find(const std::string& value) const;
  /// The first of a value that is one of several elements; null: there is none.
  const Tree* First(const std::string& value, std::initializer_list<const char*> elements) const;

private:
  std::unordered_map<std::string, std::vector<const Tree*>> Children;
};

/// The ids that the mesh has.
struct KnownIds
{
  /// Sorted, each once.
  std::vector<Id> Ids;
  /// Of what they are: "node" or "element".
  std::string What;
};

/// The ids of a set: those of the children (2.5, 3.0), or a list (4.0), in which first:last and
/// first:last:step are ranges. The mesh has each of them, and no set names more than the mesh has:
/// so a short text cannot stand for more than the mesh that it is about.
/// @throws palpate::InputError an id that is none, that the mesh has not, or one too many.
std::vector<Id> IdsOf(const Tree& set, const KnownIds& known);

/// Those of a part or of a set of elements.
/// @param where Names it.
/// @param sets Of the mesh.
/// @throws palpate::InputError there is none of that name, or as IdsOf().
std::vector<Id> ElementsOf(
  const ChildIndex& sets, const std::string& name, const Tree& where, const KnownIds& known);

bool StartsWith(const std::string& text, const char* start);
}
