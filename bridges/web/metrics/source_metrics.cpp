// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/metrics/source_metrics.h"

#include <array>

namespace disparityd::web {
namespace {

using namespace std::string_view_literals;

constexpr std::array camera_states{"starting"sv,     "streaming"sv,      "absent"sv,       "stalled"sv,
                                   "busy"sv,         "no-permission"sv,  "old-firmware"sv, "usb2-link"sv,
                                   "mode-refused"sv, "no-calibration"sv, "changed"sv,      "failed"sv};
constexpr std::array sensor_states{"starting"sv, "streaming"sv, "absent"sv, "silent"sv, "no-permission"sv, "failed"sv};

}  // namespace

void put_camera(Exposition& out, const v1::CameraStatus& camera) {
    out.states("disparityd_camera_state", "State of the live camera, 1 for the one it is in.", camera_states,
               camera.state());
    out.info("disparityd_camera_info", "The live camera, empty until one is found.",
             {{"model", camera.model()},
              {"serial", camera.serial()},
              {"firmware", camera.firmware()},
              {"port", camera.port()}});
    out.gauge("disparityd_camera_rate_hertz", "Frames per second as agreed on with the camera, 0 = unknown.",
              camera.rate());
    constexpr double bytes_of_mbit = 1e6 / 8;
    out.gauge("disparityd_camera_link_bytes_per_second", "Speed of the USB link, 0 = unknown.",
              camera.speed_mbit() * bytes_of_mbit);
    out.counter("disparityd_camera_arrivals_total", "How often the camera was found.", camera.arrivals());
    out.counter("disparityd_camera_restarts_total", "Restarts of the stream after a stall.", camera.restarts());
    out.counter("disparityd_camera_reopens_total", "How often the device was opened anew.", camera.reopens());
    out.counter("disparityd_camera_resets_total", "Resets of the camera on the USB.", camera.resets());
    out.counter("disparityd_camera_frames_damaged_total", "Frames that the driver flagged as damaged.",
                camera.damaged());
    out.counter("disparityd_camera_frames_too_short_total", "Frames that lacked bytes.", camera.too_short());
}

void put_sensors(Exposition& out, const v1::SensorStatus& sensors) {
    out.states("disparityd_sensors_state", "State of the camera's sensors, 1 for the one they are in.", sensor_states,
               sensors.state());
    out.counter("disparityd_sensors_samples_total", "Samples that the sensors gave.", sensors.samples());
    out.counter("disparityd_sensors_samples_lost_total", "Samples that no frame followed in time.", sensors.lost());
    out.counter("disparityd_sensors_reports_refused_total", "Reports of the device that could not be read.",
                sensors.refused());
    out.counter("disparityd_sensors_clock_jumps_total", "Jumps of the camera's clock.", sensors.clock_jumps());
    constexpr double ppm = 1e6;
    out.gauge("disparityd_sensors_clock_drift_ratio", "How much faster the daemon's clock runs than the camera's.",
              sensors.drift_ppm() / ppm);
}

void put_self_calibration(Exposition& out, const v1::SelfCalibration& calibration) {
    out.gauge("disparityd_self_calibration_estimating", "Whether corrections are estimated from the frames.",
              calibration.estimating() ? 1 : 0);
    out.gauge("disparityd_self_calibration_corrected", "Whether a correction is in use.",
              calibration.corrected() ? 1 : 0);
    out.begin("disparityd_self_calibration_angle_degrees", "gauge",
              "Correction of the right camera, about its own axes.");
    out.sample({{"axis", "pitch"}}, calibration.pitch_degrees());
    out.sample({{"axis", "yaw"}}, calibration.yaw_degrees());
    out.sample({{"axis", "roll"}}, calibration.roll_degrees());
    out.gauge("disparityd_self_calibration_focal_ratio", "Right focal length against the factory's.",
              calibration.focal_ratio());
    // 0 says that nothing was measured: a sample would look like a perfect camera.
    if (calibration.error_before_px() > 0 || calibration.error_after_px() > 0) {
        out.begin("disparityd_self_calibration_error_pixels", "gauge",
                  "Median vertical distance of matches, by the factory's calibration and with the correction.");
        if (calibration.error_before_px() > 0) {
            out.sample({{"calibration", "factory"}}, calibration.error_before_px());
        }
        if (calibration.error_after_px() > 0) {
            out.sample({{"calibration", "corrected"}}, calibration.error_after_px());
        }
    }
    out.gauge("disparityd_self_calibration_frames", "Frames that the last fit used.", calibration.frames());
    out.gauge("disparityd_self_calibration_matches", "Matches that the last fit used.", calibration.matches());
}

}  // namespace disparityd::web
