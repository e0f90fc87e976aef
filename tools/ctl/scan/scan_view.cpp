// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/scan/scan_view.h"

#include <algorithm>
#include <vector>

#include "tools/command_line/table.h"
#include "tools/ctl/scan/live_screen.h"
#include "tools/ctl/scan/radar.h"
#include "tools/ctl/scan/scan_lines.h"

namespace disparityd::tools {
namespace {

class LinesView : public ScanView {
public:
    bool taken(std::chrono::milliseconds longest) override { return lines_.read(longest); }

protected:
    void put(const std::string& line) { lines_.put(line); }

private:
    ScanLines lines_;
};

class JsonScanView final : public LinesView {
public:
    void show(const ScanReading& reading) override { put(to_text(scan_json(reading), -1)); }
    void show_none(const std::string& why, double /*silent_s*/) override { put(to_text(no_scan_json(why), -1)); }
};

class LineScanView final : public LinesView {
public:
    LineScanView() { put(scan_heading()); }
    void show(const ScanReading& reading) override { put(scan_line(reading)); }
    void show_none(const std::string& why, double /*silent_s*/) override { put(no_scan_line(why)); }
};

/// Draws the newest scan. While none comes, the plot shows its sectors as unknown: an old scan says nothing of now.
class RadarScanView final : public ScanView {
public:
    explicit RadarScanView(const RadarChoice& choice)
        : ascii_(choice.ascii || !screen_.utf8()), fixed_range_m_(choice.range_m) {}

    void show(const ScanReading& reading) override {
        hidden_ = false;
        last_ = reading.scan;
        range_m_ = std::max(range_m_, fitting_range(last_));  // grows only: a scale that jumps cannot be read
        draw(scan_parts(reading), last_);
    }

    void hide(double silent_s) override {
        if (!hidden_) {
            show_none("asking the daemon why", silent_s);
        }
    }

    void show_none(const std::string& why, double silent_s) override {
        hidden_ = true;
        draw({"NO SCAN for " + fixed(silent_s, 0) + " s, so nothing is known", why}, all_unknown(last_));
    }

private:
    void draw(const std::vector<std::string>& parts, const disparity::Scan& scan) {
        std::vector<std::string> lines = wrapped(parts, screen_.columns() - 1);
        lines.resize(std::max<std::size_t>(lines.size(), 2));  // so that the plot stays where it is
        RadarStyle style;
        style.columns = screen_.columns() - 1;
        style.rows = screen_.rows() - 1 - static_cast<int>(lines.size());
        style.range_m = fixed_range_m_.value_or(range_m_);
        style.ascii = ascii_;
        const auto plot = radar_lines(draw_radar(scan, style), screen_.colour());
        lines.insert(lines.end(), plot.begin(), plot.end());
        screen_.show(lines);
    }

    LiveScreen screen_;
    bool ascii_;
    std::optional<double> fixed_range_m_;
    bool hidden_ = false;
    double range_m_ = 1;
    disparity::Scan last_;
};

}  // namespace

std::unique_ptr<ScanView> json_scan_view() {
    return std::make_unique<JsonScanView>();
}

std::unique_ptr<ScanView> line_scan_view() {
    return std::make_unique<LineScanView>();
}

std::unique_ptr<ScanView> radar_scan_view(const RadarChoice& choice) {
    return std::make_unique<RadarScanView>(choice);
}

}  // namespace disparityd::tools
