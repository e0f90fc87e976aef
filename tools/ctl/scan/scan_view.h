// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/ctl/scan/scan_text.h"

namespace disparityd::tools {

/// Shows pictures of text on standard output: on a terminal each in the place of the one before, elsewhere one after
/// the other. One thread uses it.
class LiveScreen {
public:
    LiveScreen();

    bool in_place() const { return in_place_; }  ///< standard output is a terminal that can do so
    bool colour() const;                         ///< it shows colours, and NO_COLOR is not set
    bool utf8() const;                           ///< the locale says so

    /// The size of the terminal now; 80 x 24 where there is none.
    int columns() const;
    int rows() const;

    /// Lines must be printable, but for colours. Throws std::runtime_error when they cannot be written.
    void show(const std::vector<std::string>& lines);

private:
    bool in_place_;
    bool cleared_ = false;
};

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
