// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "calibration/rectification.h"
#include "capture/camera/camera_survey.h"
#include "capture/frame_source.h"
#include "kernels/options.h"
#include "kernels/scan/scan_options.h"
#include "proto/disparity.pb.h"

/// Converts the project's types to JSON, with the keys in the order in which people read them.
namespace disparityd::tools {

using Json = nlohmann::ordered_json;

Json to_json(const v1::Status& status);
Json to_json(const v1::RecordStatus& status);
Json to_json(const v1::SelfCalibration& status);
Json to_json(const v1::CameraStatus& camera);
Json to_json(const v1::SensorStatus& sensors);
Json to_json(const v1::CameraControls& controls);
Json to_json(const capture::CameraSurvey& camera);
Json to_json(const capture::SourceInfo& source);
Json to_json(const calibration::StereoCalibration& calibration);
Json to_json(const calibration::Rectification& rectification);
Json to_json(const MatchOptions& options);
Json to_json(const ScanOptions& options);

/// Returns 16 hexadecimal digits: JSON's numbers cannot hold 64 bits.
std::string hexadecimal(std::uint64_t id);

/// Returns the JSON as text. Bytes that are not UTF-8 are replaced.
std::string to_text(const Json& json, int indent);

}  // namespace disparityd::tools
