// Umbrella header of all of kinecal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture.hpp"
#include "kinecal/core.hpp"
#include "kinecal/io.hpp"
#include "kinecal/report.hpp"
#include "kinecal/solve.hpp"
#include "kinecal/study.hpp"
#include "kinecal/trust.hpp"
