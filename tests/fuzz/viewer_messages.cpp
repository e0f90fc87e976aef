// SPDX-License-Identifier: Apache-2.0
//
// Texts of a viewer that speaks Foxglove's protocol.
#include "bridges/web/foxglove/client_text.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text = fuzz::text_of(data, size);
    const foxglove::ClientRequest request = foxglove::read_client_text(text);
    if (const auto* refused = std::get_if<foxglove::Refusal>(&request)) {
        fuzz::expect_line(refused->why, "");
    } else if (const auto* asked = std::get_if<foxglove::SubscribeRequest>(&request)) {
        fuzz::expect(asked->items.size() < size, "more subscriptions than bytes");
    } else {
        fuzz::expect(std::get<foxglove::UnsubscribeRequest>(request).ids.size() < size, "more ids than bytes");
    }
    return 0;
}
