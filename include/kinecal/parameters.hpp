// Umbrella header of parameters/: named parameters, free and held.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/parameters/chain_parameters.hpp"
#include "kinecal/parameters/free_parameters.hpp"
#include "kinecal/parameters/joint_models/joint_model.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/parameters/joint_parameters.hpp"
#include "kinecal/parameters/own_parameters.hpp"
#include "kinecal/parameters/parameter.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/parameters/parameter_values.hpp"
