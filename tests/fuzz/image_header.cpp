// SPDX-License-Identifier: Apache-2.0
//
// The headers of images: PNG, JPEG, PNM, PFM, BMP, TIFF, WebP.
#include "capture/images/image_header.h"

#include <sstream>
#include <string>

#include "tests/fuzz/outcome.h"

using namespace disparityd;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::istringstream file{std::string(fuzz::text_of(data, size))};
    if (const auto found = capture::read_image_header(file)) {
        fuzz::expect(found->width >= 0 && found->height >= 0, "a side of an image is negative");
    }
    return 0;
}
