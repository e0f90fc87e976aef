// SPDX-License-Identifier: Apache-2.0
//
// The bytes of one connection to disparity-web: HTTP requests, and what may follow them.
#include "tests/fuzz/outcome.h"
#include "tests/fuzz/web_visitor.h"

using namespace disparityd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::WebVisitor visitor;
    visitor.say(fuzz::text_of(data, size));
    visitor.publish();
    const std::string answers = visitor.take_answers();
    fuzz::expect(answers.empty() || answers.size() > 60000 || answers.starts_with("HTTP/1.1 ") ||
                     answers.starts_with("HTTP/1.0 "),
                 "an answer that is no HTTP");
    return 0;
}
