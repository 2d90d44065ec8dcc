// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/transfer.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"

namespace palpate::test::test_transfer {
namespace {

template <class T>
bool is_refused(const Bytes& bytes) {
  try {
    (void)Unpacker(bytes).take<T>();
  } catch (const BackendError&) {
    return true;
  }
  return false;
}

/// The first number of the bytes is a size; it is replaced.
Bytes with_size(Bytes bytes, std::size_t place, std::int64_t size) {
  std::memcpy(bytes.data() + place * sizeof size, &size, sizeof size);
  return bytes;
}

template <class T>
Bytes bytes_of(const T& value) {
  Packer packer;
  packer.put(value);
  return packer.take();
}

template <class T>
void expect_bounded(const T& value, std::size_t num_sizes) {
  const Bytes whole = bytes_of(value);
  EXPECT_EQ(Unpacker(whole).take<T>(), value);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_TRUE(is_refused<T>(Bytes(whole.begin(), whole.begin() + static_cast<int>(size))))
        << size;
  }
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (std::size_t place = 0; place < num_sizes; ++place) {
    for (const std::int64_t size : {kMost, kMost / 2 + 1, std::int64_t{1} << 40, std::int64_t{-1},
                                    std::numeric_limits<std::int64_t>::min()}) {
      EXPECT_TRUE(is_refused<T>(with_size(whole, place, size))) << place << ' ' << size;
    }
  }
}

// Nothing is read beyond the end, and nothing is made of a size that the bytes have not.
TEST(Transfer, WhatIsDamagedIsRefused) {
  expect_bounded(std::vector<double>{1, 2, 3}, 1);
  expect_bounded(std::vector<std::vector<int>>{{1}, {2, 3}}, 2);
  expect_bounded(std::map<int, double>{{1, 2.0}, {3, 4.0}}, 1);
  expect_bounded(Eigen::MatrixXd(Eigen::MatrixXd::Random(3, 2)), 2);
  expect_bounded(Eigen::VectorXd(Eigen::VectorXd::Random(3)), 2);
  expect_bounded(std::int64_t{7}, 0);
}

TEST(Transfer, AMatrixWithoutValuesHasBoundsToo) {
  const Eigen::MatrixXd none(0, 3);
  const Bytes bytes = bytes_of(none);
  const auto back = Unpacker(bytes).take<Eigen::MatrixXd>();
  EXPECT_EQ(back.cols(), 3);
  EXPECT_TRUE(is_refused<Eigen::MatrixXd>(with_size(bytes, 1, std::int64_t{1} << 62)));
  // A vector has one column.
  EXPECT_TRUE(is_refused<Eigen::VectorXd>(bytes));
}

}  // namespace
}  // namespace palpate::test::test_transfer
