// Umbrella header of explain/: what may be wrong where samples fit badly.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/explain/explain_fit.hpp"
#include "kinecal/explain/judge_causes.hpp"
#include "kinecal/explain/suspect.hpp"
#include "kinecal/explain/would_help.hpp"
