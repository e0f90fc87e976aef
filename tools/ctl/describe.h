// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "capture/camera_survey.h"
#include "capture/frame_source.h"
#include "capture/rectification.h"
#include "kernels/options.h"
#include "proto/disparity.pb.h"

/// The project's types as JSON, keys in the order in which people read them.
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
Json to_json(const capture::StereoCalibration& calibration);
Json to_json(const capture::Rectification& rectification);
Json to_json(const MatchOptions& options);

/// 16 hexadecimal digits: JSON's numbers cannot hold 64 bits.
std::string hexadecimal(std::uint64_t id);

/// Strings of unknown origin may not be UTF-8; those bytes are replaced.
std::string to_text(const Json& json, int indent);

}  // namespace disparityd::tools
