// SPDX-License-Identifier: Apache-2.0
//
// Texts that a page sends over its WebSocket.
#include "bridges/web/live/live_message.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

constexpr int most_width = 16384;

void check(const web::WrongMessage& wrong) {
    fuzz::expect_line(wrong.error, "");
}

void check(const web::Seen&) {}

void check(const web::Point& point) {
    fuzz::expect(!point.pixel || (point.pixel->first <= most_width && point.pixel->second <= most_width),
                 "a pixel outside of every image");
}

/// What is accepted is what docs/web.md allows: other code relies on it.
void check(const web::LiveSubscription& wanted) {
    fuzz::expect(wanted.images.size() <= 5, "an image twice");
    fuzz::expect(wanted.max_width >= 0 && wanted.max_width <= most_width, "a width out of range");
    fuzz::expect(wanted.max_rate == 0 || (wanted.max_rate >= 0.01 && wanted.max_rate <= 1000), "a rate out of range");
    fuzz::expect(wanted.cloud_step >= 0 && wanted.cloud_step <= 64, "a step out of range");
    fuzz::expect(!wanted.range || (wanted.range->near > 0 && wanted.range->far > wanted.range->near),
                 "a range without an inside");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::visit([](const auto& request) { check(request); }, web::parse_live_request(fuzz::text_of(data, size)));
    return 0;
}
