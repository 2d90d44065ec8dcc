// SPDX-License-Identifier: BSD-3-Clause
// Lines that are kept in memory while time matters, and written when it no longer does.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace palpate::test {

class Log {
 public:
  explicit Log(std::string path) : path_(std::move(path)) { text_.reserve(std::size_t{16} << 20); }

  /// A line, as printf() makes it.
  [[gnu::format(printf, 2, 3)]] void add(const char* format, ...) {
    char line[256];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    (text_ += line) += '\n';
  }

  /// Adds the lines to the file.
  void write() {
    if (std::FILE* file = std::fopen(path_.c_str(), "a")) {
      std::fputs(text_.c_str(), file);
      std::fclose(file);
    }
    text_.clear();
  }

 private:
  std::string path_;
  std::string text_;
};

}  // namespace palpate::test
