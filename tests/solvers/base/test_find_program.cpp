// SPDX-License-Identifier: BSD-3-Clause
#include "base/find_program.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/error.h"

namespace palpate::test::test_find_program {
namespace {

constexpr const char* kVariable = "PALPATE_TEST_FIND_PROGRAM";

std::string error_of(const std::string& name) {
  try {
    (void)find_program(name, kVariable, "Build it");
  } catch (const BackendError& error) {
    return error.what();
  }
  return {};
}

TEST(FindProgram, BesideThisOne) {
  const auto here = std::filesystem::canonical("/proc/self/exe");
  EXPECT_EQ(find_program(here.filename(), kVariable, ""), here);
}

TEST(FindProgram, InAFolderBinAbove) {
  const auto found = find_program("env", kVariable, "");
  EXPECT_EQ(std::filesystem::path(found).parent_path().filename(), "bin") << found;
}

TEST(FindProgram, TheOneThatTheEnvironmentNames) {
  ::setenv(kVariable, "/bin/sh", 1);
  EXPECT_EQ(find_program("whatever", kVariable, ""), "/bin/sh");
  ::setenv(kVariable, "/etc/passwd", 1);
  EXPECT_EQ(error_of("whatever"), std::string("The environment variable ") + kVariable +
                                      " names no program: /etc/passwd.");
  ::unsetenv(kVariable);
}

TEST(FindProgram, SaysWhereItIsNot) {
  const std::string error = error_of("there-is-no-such-program");
  const auto folder = std::filesystem::canonical("/proc/self/exe").parent_path().string();
  for (const std::string& part : {std::string("there-is-no-such-program"), folder,
                                  std::string("Build it"), std::string(kVariable)}) {
    EXPECT_NE(error.find(part), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace palpate::test::test_find_program
