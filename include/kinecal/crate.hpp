// Umbrella header of crate/: a calibration as a type, and its checks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/crate.hpp"
#include "kinecal/crate/crate_checks.hpp"
#include "kinecal/crate/crate_parts.hpp"
#include "kinecal/crate/parameter_checks.hpp"
#include "kinecal/crate/parameter_use.hpp"
