// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "tools/ctl/scan/scan_text.h"

namespace disparityd::tools {

/// A way to show scans.
class ScanView {
public:
    virtual ~ScanView() = default;
    /// Waits until whoever reads what is shown has taken the last one, `longest` at most; returns whether it has.
    virtual bool taken(std::chrono::milliseconds /*longest*/) { return true; }
    virtual void show(const ScanReading& reading) = 0;
    /// Takes away what is no longer true, before the daemon is asked why no scan comes: that may take 5 s.
    virtual void hide(double /*silent_s*/) {}
    /// No scan has come; `silent_s`: for so long.
    virtual void show_none(const std::string& why, double silent_s) = 0;
};

/// Says how the radar is drawn; what is not given follows the terminal and the scans.
struct RadarChoice {
    bool ascii = false;
    std::optional<double> range_m;
};

std::unique_ptr<ScanView> json_scan_view();
std::unique_ptr<ScanView> line_scan_view();
std::unique_ptr<ScanView> radar_scan_view(const RadarChoice& choice);

}  // namespace disparityd::tools
