// The whole of kinecal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "kinecal/geometry.hpp"
#include "kinecal/io.hpp"
#include "kinecal/kinematics.hpp"
#include "kinecal/parameters.hpp"
#include "kinecal/report.hpp"
#include "kinecal/samples.hpp"
#include "kinecal/sensors.hpp"
#include "kinecal/solve.hpp"
#include "kinecal/trust.hpp"
