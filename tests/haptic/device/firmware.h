// SPDX-License-Identifier: BSD-3-Clause
// Our own report (haptic/README.md) as a board's firmware writes it down: bytes in the order of
// these structures, little endian as the processor has them. Nothing of
// haptic/profile/palpate_report.h is used, on purpose: a mistake there shall not be made here too.
#pragma once

#include <cstdint>

namespace palpate::test::firmware {

struct [[gnu::packed]] Feature {
  std::uint8_t number = 1;
  char magic[4] = {'P', 'L', 'P', 'T'};
  std::uint8_t version = 1;
  std::uint8_t motors = 0b111;
  std::uint8_t buttons = 3;
  std::uint32_t position_unit_nm = 0;
  std::uint32_t force_unit_un = 0;
  std::uint16_t largest_force_mn = 6000;
  std::uint16_t largest_stiffness = 3000;
  std::uint16_t largest_damping = 1000;
  std::uint16_t workspace_radius_100um = 800;
  std::uint16_t watchdog_ms = 50;
  std::uint16_t interval_us = 1000;
  char model[16] = "not there";
};
static_assert(sizeof(Feature) == 44);

struct [[gnu::packed]] Input {
  std::uint8_t number = 2;
  std::uint32_t time_us = 0;
  std::uint16_t counter = 0;
  std::int32_t position[3] = {};
  std::int16_t rotation[4] = {32767, 0, 0, 0};
  std::uint8_t buttons = 0;
  std::uint8_t status = 0;
};
static_assert(sizeof(Input) == 29);

struct [[gnu::packed]] Output {
  std::uint8_t number = 0;
  std::uint16_t counter = 0;
  std::int16_t force[3] = {};
  std::uint8_t command = 0;
};
static_assert(sizeof(Output) == 10);

}  // namespace palpate::test::firmware
