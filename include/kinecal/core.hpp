// Umbrella header of kinecal::core: geometry/ to crate/, which need only Eigen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "kinecal/evaluation.hpp"
#include "kinecal/geometry.hpp"
#include "kinecal/kinematics.hpp"
#include "kinecal/parameters.hpp"
#include "kinecal/problem.hpp"
#include "kinecal/samples.hpp"
#include "kinecal/sensors.hpp"
#include "kinecal/text.hpp"
