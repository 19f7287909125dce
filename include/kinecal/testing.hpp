// Checks for tests: a sensor, an error block or a walker of your own against the laws of CONCEPTS.md.
//
//   EXPECT_EQ(check_block(Height{}), kLawsHold);          // GoogleTest
//   REQUIRE(check_sensor(DrawWire{}) == kLawsHold);       // Catch2, doctest
//   if (const Verdict v = check_block(Height{}); !v) std::cerr << v << '\n';
//
// A check gives a Verdict: kLawsHold, or the first broken law with the numbers on both sides.  Inputs
// are random with a fixed seed, so a verdict does not change between runs.  Each check states its
// tolerances.
//
// kinecal/kinecal.hpp does not include this header: programs do not need it, tests do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/testing/block_input.hpp"
#include "kinecal/testing/check_block.hpp"
#include "kinecal/testing/check_sensor.hpp"
#include "kinecal/testing/check_walker.hpp"
#include "kinecal/testing/comparison.hpp"
#include "kinecal/testing/field_of_view.hpp"
#include "kinecal/testing/random_input.hpp"
#include "kinecal/testing/sensor_input.hpp"
#include "kinecal/testing/typical_observations.hpp"
#include "kinecal/testing/verdict.hpp"
