// SPDX-License-Identifier: Apache-2.0
//
// Images: PNG, JPEG, PNM, PFM, BMP, TIFF, WebP. Their headers, and all of small ones.
#include "capture/images/image_header.h"

#include <sstream>
#include <stdexcept>
#include <string>

#include "capture/images/image_files.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::istringstream file{std::string(fuzz::text_of(data, size))};
    if (const auto found = capture::read_image_header(file)) {
        fuzz::expect(found->width >= 0 && found->height >= 0, "a side of an image is negative");
        constexpr int small = 256;
        if (found->width <= small && found->height <= small) {
            try {
                capture::decode_image({data, size}, "image");
            } catch (const std::runtime_error&) {  // no memory
            } catch (const std::invalid_argument&) {
            }
        }
    }
    return 0;
}
