// Umbrella header of all of kinecal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture.hpp"
#include "kinecal/config.hpp"
#include "kinecal/core.hpp"
#include "kinecal/explain.hpp"
#include "kinecal/files.hpp"
#include "kinecal/procedure.hpp"
#include "kinecal/report.hpp"
#include "kinecal/robots.hpp"
#include "kinecal/solve.hpp"
#include "kinecal/study.hpp"
#include "kinecal/surface.hpp"
#include "kinecal/tools.hpp"
#include "kinecal/trust.hpp"
