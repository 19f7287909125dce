// Umbrella header of report/: results for people and programs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/report/findings.hpp"
#include "kinecal/report/json.hpp"
#include "kinecal/report/recorded_poses.hpp"
#include "kinecal/report/report_data.hpp"
#include "kinecal/report/residuals_csv.hpp"
#include "kinecal/report/robot_scene.hpp"
#include "kinecal/report/scene_json.hpp"
#include "kinecal/report/scene_mcap.hpp"
#include "kinecal/report/scene_meshes.hpp"
#include "kinecal/report/scene_text.hpp"
#include "kinecal/report/text.hpp"
