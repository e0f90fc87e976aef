// SPDX-License-Identifier: Apache-2.0
//
// Writes metrics to standard output, for promtool and for the checks of docs/monitoring: of a filled status, or of what
// the argument says.
#include <array>
#include <cstdio>
#include <string>
#include <string_view>

#include "bridges/web/metrics/prometheus_text.h"
#include "tests/bridges/metrics/filled_status.h"

int main(int argc, char** argv) {
    using namespace disparityd;
    const std::string_view which = argc > 1 ? argv[1] : "filled";
    v1::Status status;
    if (which == "filled") {
        status = test::filled_status();
    } else if (which == "hostile") {
        status = test::hostile_status();
    } else if (which == "starting") {
        status = test::starting_status();
    } else if (which == "several") {
        status = test::filled_status();
    } else if (which != "absent") {
        std::fprintf(stderr, "metrics_text: error: found '%s', allowed: filled, hostile, starting, absent, several\n",
                     argv[1]);
        return 2;
    }
    const v1::Status starting = test::starting_status();
    const std::array several{web::NamedStatus{"away", nullptr}, web::NamedStatus{"front", &status},
                             web::NamedStatus{"late", &starting}, web::NamedStatus{"rear", &status}};
    const std::string text = which == "several"
                                 ? web::prometheus_text(several, test::web_counters())
                                 : web::prometheus_text(which == "absent" ? nullptr : &status, test::web_counters());
    return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0 ? 0 : 1;
}
