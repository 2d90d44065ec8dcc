// SPDX-License-Identifier: BSD-3-Clause
#include "storage/table.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/join.h"
#include "storage/schema.h"
#include "storage/versions.h"

namespace palpate::storage {
namespace {

/// The parts of a list that commas separate. Commas within parentheses do not count.
std::vector<std::string> parts_of(const std::string& list) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : list) {
    if (c == ',' && depth == 0) {
      parts.emplace_back();
      continue;
    }
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    parts.back() += c;
  }
  return parts;
}

/// The text between the first parenthesis and the last one.
std::string between_parentheses(const std::string& text) {
  const std::size_t first = text.find('(') + 1;
  return text.substr(first, text.rfind(')') - first);
}

}  // namespace

Table::Table(std::string name) : name_(std::move(name)) {
  static const std::map<std::string, std::string> tables = tables_of_version(kSchemaVersion);
  for (const std::string& part : parts_of(between_parentheses(tables.at(name_)))) {
    if (part.compare(0, 11, "PRIMARY KEY") == 0) {
      key_ = parts_of(between_parentheses(part));
    } else {
      columns_.push_back(part.substr(0, part.find(' ')));
    }
  }
}

std::string Table::columns(const std::string& first, const std::string& end) const {
  const auto begin = std::find(columns_.begin(), columns_.end(), first);
  return join({begin, std::find(begin, columns_.end(), end)});
}

std::vector<std::string> Table::key_from(const std::string& first) const {
  return {std::find(key_.begin(), key_.end(), first), key_.end()};
}

std::string Table::insert_into(const std::string& where_there_is_one) const {
  return "INSERT OR " + where_there_is_one + " INTO " + name_ + " (" + join(columns_) + ')';
}

std::string Table::parameters() const {
  std::vector<std::string> numbers;
  for (std::size_t c = 1; c <= columns_.size(); ++c) numbers.push_back('?' + std::to_string(c));
  return join(numbers);
}

}  // namespace palpate::storage
