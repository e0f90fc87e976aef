// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/metrics/filled_status.h"

namespace disparityd::test {
namespace {

void add_step(v1::Totals& totals, const char* name, std::initializer_list<std::uint64_t> up_to, std::uint64_t count,
              std::uint64_t sum_ns) {
    v1::StepTotal& step = *totals.add_steps();
    step.set_name(name);
    step.mutable_up_to()->Assign(up_to.begin(), up_to.end());
    step.set_count(count);
    step.set_sum_ns(sum_ns);
}

void fill_totals(v1::Totals& totals) {
    totals.set_captured(5000000000);
    totals.set_published(4999999000);
    totals.set_dropped(900);
    totals.set_lost(12);
    totals.set_damaged(3);
    totals.set_unwanted(4);
    totals.set_over_budget(6);
    for (const std::uint32_t bound : {100U, 20000U, 1000000U}) {
        totals.add_bounds_us(bound);
    }
    add_step(totals, "capture", {7, 9, 9}, 10, 1234567890);
    add_step(totals, "total", {0, 8, 9}, 9, 250000000);
    add_step(totals, "scan", {1, 1, 1}, 1, 50);
    totals.set_clients(17);
    totals.set_client_frames_sent(123);
    totals.set_client_frames_skipped(45);
    totals.set_client_bytes_sent(6789);
}

void fill_camera(v1::CameraStatus& camera) {
    camera.set_state("stalled");
    camera.set_model("ZED 2");
    camera.set_serial("12345");
    camera.set_node("/dev/video0");
    camera.set_port("2-1");
    camera.set_firmware("1523");
    camera.set_speed_mbit(5000);
    camera.set_rate(30);
    camera.set_arrivals(2);
    camera.set_restarts(3);
    camera.set_reopens(4);
    camera.set_resets(5);
    camera.set_damaged(6);
    camera.set_too_short(7);
    camera.set_unpaired(8);
    camera.mutable_eyes_apart()->set_median_us(-250);
    camera.mutable_eyes_apart()->set_drift_ppm(1.5);
}

void fill_sensors(v1::SensorStatus& sensors) {
    sensors.set_state("streaming");
    sensors.set_samples(4000);
    sensors.set_lost(8);
    sensors.set_refused(9);
    sensors.set_clock_jumps(1);
    sensors.set_drift_ppm(-12.5);
}

void fill_self_calibration(v1::SelfCalibration& calibration) {
    calibration.set_estimating(true);
    calibration.set_corrected(true);
    calibration.set_pitch_degrees(0.125);
    calibration.set_yaw_degrees(-0.0625);
    calibration.set_roll_degrees(0.03);
    calibration.set_focal_ratio(1.0005);
    calibration.set_error_before_px(0.75);
    calibration.set_error_after_px(0.0625);
    calibration.set_frames(8);
    calibration.set_matches(2345);
}

}  // namespace

v1::Status filled_status() {
    v1::Status status;
    status.set_server_version("1.2.3");
    status.set_state("running");
    status.set_source("v4l2:auto");
    status.set_method("sgm");
    status.set_backend("cpu");
    status.set_workers(4);
    status.set_rate(29.97);
    status.mutable_measured()->set_ratio(0.25);
    status.mutable_measured()->set_likely_cause("dark");
    status.mutable_level()->set_source("autopilot");
    status.mutable_level()->set_age_ms(12.5);
    status.mutable_trust()->set_ratio(0.5);
    status.mutable_trust()->add_doubts("dirty-eye");
    status.mutable_trust()->set_alarm("clean it");
    status.mutable_scan()->set_sectors(72);
    status.mutable_scan()->set_doubted(9);
    v1::SectorDoubt& doubt = *status.mutable_scan()->add_doubts();
    doubt.set_doubt("saturated");
    doubt.set_sectors(8);
    status.mutable_measured()->set_near_ratio(0.125);
    status.mutable_measured()->set_noise(2.5);
    status.mutable_measured()->set_noise_level(2);
    status.mutable_budget()->set_cores(1.5);
    status.mutable_budget()->set_used(1.25);
    status.set_uptime_s(3600.5);
    status.add_notices("no huge pages");
    // Of the engine in use; the totals count.
    status.set_captured(1);
    status.set_published(1);
    for (const char* name : {"first", "second"}) {
        v1::ClientStatus& client = *status.add_clients();
        client.set_name(name);
        client.set_frames_sent(1);
    }
    v1::RecordStatus& record = *status.mutable_record();
    record.set_active(true);
    record.set_path("a.mkv");
    record.set_frames(100);
    record.set_dropped(2);
    record.set_lost(1);
    record.set_bytes(5000000000);
    record.set_seconds(3.5);
    fill_totals(*status.mutable_totals());
    fill_camera(*status.mutable_camera());
    fill_sensors(*status.mutable_sensors());
    fill_self_calibration(*status.mutable_self_calibration());
    return status;
}

v1::Status hostile_status() {
    v1::Status status = filled_status();
    status.set_server_version("1\"} 5\ndisparityd_up 7");
    status.set_state("run\\ning");
    using namespace std::string_literals;
    status.set_source("back\\slash, \"quote\", two\nlines, \t\r\0 and \x7f"s);
    status.set_method("\xff\xfe half a character \xc3");
    status.set_backend("caf\xc3\xa9");
    status.mutable_camera()->set_model("{}#");
    status.mutable_camera()->set_state("");
    status.mutable_totals()->mutable_steps(0)->set_name("\",le=\"0\\");
    return status;
}

v1::Status starting_status() {
    v1::Status status;
    status.set_server_version("1.2.3");
    status.set_state("waiting");
    status.mutable_totals();
    return status;
}

web::WebCounters web_counters() {
    return {.clients = 2, .bytes_sent = 3, .frames_sent = 4, .frames_skipped = 5, .requests = 6, .refused = 1};
}

}  // namespace disparityd::test
