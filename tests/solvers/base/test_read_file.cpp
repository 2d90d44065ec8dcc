// SPDX-License-Identifier: BSD-3-Clause
#include "base/read_file.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "solvers/support/message_of.h"

namespace palpate::test::test_read_file {
namespace {

class ReadFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "/palpate_XXXXXX";
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static std::string error_of(const std::filesystem::path& path) {
    return test::message_of([&] { (void)open_to_read(path); });
  }

  std::filesystem::path folder_;
};

TEST_F(ReadFile, OpensAFileAndALinkToOne) {
  std::ofstream(folder_ / "file") << "text";
  std::filesystem::create_symlink("file", folder_ / "link");
  for (const char* name : {"file", "link"}) {
    std::ifstream stream = open_to_read(folder_ / name);
    std::string text;
    stream >> text;
    EXPECT_EQ(text, "text");
  }
}

// Each of them would keep the program waiting, or never end.
TEST_F(ReadFile, RefusesWhatIsNoFile) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  std::filesystem::create_symlink("pipe", folder_ / "link");
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string place = folder_ / "socket";
  ASSERT_LT(place.size(), sizeof address.sun_path);
  std::copy(place.begin(), place.end(), address.sun_path);
  ASSERT_EQ(::bind(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  for (const auto& path : {folder_ / "pipe", folder_ / "link", folder_ / "socket",
                           std::filesystem::path("/dev/zero")}) {
    EXPECT_NE(error_of(path).find("is a pipe, a device or the like"), std::string::npos) << path;
  }
  ::close(socket);
  EXPECT_NE(error_of(folder_).find("is a folder"), std::string::npos);
  EXPECT_NE(error_of(folder_ / "none").find("No such file"), std::string::npos);
  EXPECT_NE(error_of({}).find("cannot be opened"), std::string::npos);
  std::filesystem::create_symlink("circle", folder_ / "circle");
  EXPECT_NE(error_of(folder_ / "circle").find("Too many levels"), std::string::npos);
}

}  // namespace
}  // namespace palpate::test::test_read_file
