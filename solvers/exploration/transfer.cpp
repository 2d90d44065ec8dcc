// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/transfer.h"

#include <array>
#include <cstdint>
#include <cstring>

namespace palpate {
namespace {

void append(Bytes& bytes, const void* data, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

class Reader {
 public:
  explicit Reader(const Bytes& bytes) : bytes_(bytes) {}
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }
  void read(void* data, std::size_t size) {
    if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }

 private:
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

std::size_t num_bytes(Eigen::Index doubles) {
  return static_cast<std::size_t>(doubles) * sizeof(double);
}

}  // namespace

void append(Bytes& bytes, Index active_node, const Configuration& configuration) {
  append(bytes, &active_node, sizeof active_node);
  const ConfigurationSummary& summary = configuration;
  append(bytes, &summary, sizeof summary);
  for_each_field(configuration, [&](const auto& field) {
    const std::array<std::int64_t, 2> shape{field.rows(), field.cols()};
    append(bytes, &shape, sizeof shape);
    append(bytes, field.data(), num_bytes(field.size()));
  });
}

void append(Bytes& bytes, Index active_node, const ConfigurationSummary& summary) {
  append(bytes, active_node, Configuration{summary, {}, {}, {}, {}});
}

std::vector<FoundConfiguration> read_configurations(const Bytes& bytes) {
  std::vector<FoundConfiguration> all;
  for (Reader reader(bytes); !reader.at_end();) {
    auto& [node, configuration] = all.emplace_back();
    reader.read(&node, sizeof node);
    ConfigurationSummary& summary = configuration;
    reader.read(static_cast<void*>(&summary), sizeof summary);
    for_each_field(configuration, [&](auto& field) {
      std::array<std::int64_t, 2> shape{};
      reader.read(&shape, sizeof shape);
      field.resize(shape[0], shape[1]);
      reader.read(field.data(), num_bytes(field.size()));
    });
  }
  return all;
}

}  // namespace palpate
