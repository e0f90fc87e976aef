// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibration/depth_range.h"
#include "calibration/rectification.h"
#include "capture/camera/camera_survey.h"
#include "capture/frame_source.h"
#include "clients/json/message_json.h"
#include "kernels/options.h"
#include "obstacles/scan_options.h"

/// Converts the project's types to JSON, with the keys in the order in which people read them.
namespace disparityd::tools {

using json::hexadecimal;
using json::Json;
using json::to_json;
using json::to_text;

Json to_json(const capture::CameraSurvey& camera);
Json to_json(const capture::SourceInfo& source);
Json to_json(const calibration::StereoCalibration& calibration);
Json to_json(const calibration::Rectification& rectification);
/// Without a limit: null.
Json to_json(const calibration::DepthRange& range);
Json to_json(const MatchOptions& options);
Json to_json(const ScanOptions& options);

}  // namespace disparityd::tools
