// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioText.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/printable.h"

namespace vtkPalpateFEBio
{
namespace
{
using palpate::InputError;
using palpate::printable;

[[noreturn]] void Refuse(const Tree& element, const std::string& text, const char* due)
{
  constexpr std::size_t most = 40;
  throw InputError(Label(element) + " has '" + printable(text, most) + "' where " + due + '.');
}

constexpr const char* DueNumbers = "numbers with a comma between them are due";
constexpr const char* DueNumber = "one number is due";

/// The number of a text that holds one number with white space around it; nothing for any other
/// text.
template <class Number>
std::optional<Number> WholeNumber(std::string_view text)
{
  constexpr const char* space = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(space), text.size()));
  text = text.substr(0, text.find_last_not_of(space) + 1);
  if (text.size() > 1 && text[0] == '+' && text[1] != '-')
  {
    text.remove_prefix(1);
  }
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [behind, fault] = std::from_chars(text.data(), end, number);
  return fault == std::errc() && behind == end ? std::optional(number) : std::nullopt;
}

/// Calls f with each part of a text between commas.
template <class F>
void ForEachPiece(std::string_view text, char comma, F&& f)
{
  for (std::size_t end = 0; end != std::string_view::npos;)
  {
    end = text.find(comma);
    f(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? 0 : end + 1);
  }
}

/// Gathers the ids of a set. The mesh must have each of them, and no more may be named than there
/// are, so that a short text cannot ask for more memory than its mesh takes.
class SetIds
{
public:
  SetIds(const Tree& set, const KnownIds& known)
    : Set(set)
    , Known(known)
  {
  }

  void Add(Id id)
  {
    const auto& all = this->Known.Ids;
    if (!std::binary_search(all.begin(), all.end(), id))
    {
      throw InputError(Label(this->Set) + " has the " + this->Known.What + ' ' +
        std::to_string(id) + ", which is not among the " + this->Known.What + "s of the file.");
    }
    if (this->Ids.size() == all.size())
    {
      throw InputError(Label(this->Set) + " has more ids than the " + std::to_string(all.size()) +
        ' ' + this->Known.What + "s of the mesh. Name each once.");
    }
    this->Ids.push_back(id);
  }

  /// @param range first:last or first:last:step.
  void AddRange(std::string_view range)
  {
    const std::string text(range);
    std::array<Id, 3> bounds = { 0, 0, 1 };
    std::size_t count = 0;
    ForEachPiece(range, ':',
      [&](std::string_view piece)
      {
        const auto bound = count < bounds.size() ? WholeNumber<Id>(piece) : std::nullopt;
        if (!bound)
        {
          Refuse(this->Set, text, "a range first:last or first:last:step is due");
        }
        bounds[count++] = *bound;
      });
    const auto [first, last, step] = bounds;
    if (last < first || step < 1)
    {
      Refuse(this->Set, text, "a range that goes up is due");
    }
    // The difference of two ids need not be one.
    const auto begin = static_cast<std::uint64_t>(first);
    const auto stride = static_cast<std::uint64_t>(step);
    const std::uint64_t steps = (static_cast<std::uint64_t>(last) - begin) / stride;
    if (steps >= this->Known.Ids.size())
    {
      throw InputError(Label(this->Set) + " has the range '" + printable(text) +
        "', which is longer than the mesh: that has " + std::to_string(this->Known.Ids.size()) +
        ' ' + this->Known.What + "s.");
    }
    for (std::uint64_t i = 0; i <= steps; ++i)
    {
      this->Add(static_cast<Id>(begin + i * stride));
    }
  }

  std::vector<Id> Take() { return std::move(this->Ids); }

private:
  const Tree& Set;
  const KnownIds& Known;
  std::vector<Id> Ids;
};
}

std::string Label(const Tree& element)
{
  for (const char* name : { "name", "id", "type" })
  {
    if (const std::string* value = element.Attribute(name))
    {
      return '<' + printable(element.Name) + ' ' + name + "=\"" + printable(*value) + "\">";
    }
  }
  return '<' + printable(element.Name) + '>';
}

std::string Attribute(const Tree& element, const char* name)
{
  const std::string* value = element.Attribute(name);
  if (!value)
  {
    throw InputError(Label(element) + " has no attribute " + name + '.');
  }
  return *value;
}

const std::vector<Tree>& ChildrenOf(const Tree* element)
{
  static const std::vector<Tree> none;
  return element ? element->Children : none;
}

template <class Number>
void AppendNumbers(const std::string& text, const Tree& element, std::vector<Number>& numbers)
{
  ForEachPiece(text, ',',
    [&](std::string_view piece)
    {
      const auto number = WholeNumber<Number>(piece);
      if (!number)
      {
        Refuse(element, text, DueNumbers);
      }
      numbers.push_back(*number);
    });
}

template void AppendNumbers(const std::string&, const Tree&, std::vector<double>&);
template void AppendNumbers(const std::string&, const Tree&, std::vector<Id>&);

double NumberOf(const std::string& text, const Tree& element)
{
  const auto number = WholeNumber<double>(text);
  if (!number)
  {
    Refuse(element, text, DueNumber);
  }
  return *number;
}

Id IdOf(const Tree& element, const char* attribute)
{
  const std::string text = Attribute(element, attribute);
  const auto id = WholeNumber<Id>(text);
  if (!id)
  {
    Refuse(element, text, DueNumber);
  }
  return *id;
}

std::vector<Id> IdsOf(const Tree& set, const KnownIds& known)
{
  SetIds ids(set, known);
  for (const Tree& child : set.Children)
  {
    ids.Add(IdOf(child));
  }
  if (!set.Children.empty() || set.Text.empty())
  {
    return ids.Take();
  }
  ForEachPiece(set.Text, ',',
    [&](std::string_view piece)
    {
      if (piece.find(':') != std::string_view::npos)
      {
        ids.AddRange(piece);
        return;
      }
      const auto id = WholeNumber<Id>(piece);
      if (!id)
      {
        Refuse(set, set.Text, DueNumbers);
      }
      ids.Add(*id);
    });
  return ids.Take();
}

ChildIndex::ChildIndex(const Tree* parent, const char* attribute)
{
  for (const Tree& child : ChildrenOf(parent))
  {
    if (const std::string* value = child.Attribute(attribute))
    {
      this->Children[*value].push_back(&child);
    }
  }
}

const std::vector<const Tree*>* ChildIndex::Find(const std::string& value) const
{
  const auto found = this->Children.find(value);
  return found == this->Children.end() ? nullptr : &found->second;
}

const Tree* ChildIndex::First(
  const std::string& value, std::initializer_list<const char*> elements) const
{
  const std::vector<const Tree*>* all = this->Find(value);
  if (!all)
  {
    return nullptr;
  }
  const auto first = std::find_if(all->begin(), all->end(),
    [&elements](const Tree* child)
    { return std::find(elements.begin(), elements.end(), child->Name) != elements.end(); });
  return first == all->end() ? nullptr : *first;
}

std::vector<Id> ElementsOf(
  const ChildIndex& sets, const std::string& name, const Tree& where, const KnownIds& known)
{
  if (const Tree* set = sets.First(name, { "Elements", "ElementSet" }))
  {
    return IdsOf(*set, known);
  }
  throw InputError(Label(where) + " is about the elements '" + printable(name) +
    "', but there is neither a part nor a set of that name.");
}

bool StartsWith(const std::string& text, const char* start)
{
  return text.rfind(start, 0) == 0;
}
}
