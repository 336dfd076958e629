// Text for HTML and SVG.
#pragma once

#include <string>

namespace msf {

// `text` such that nothing in it is read as markup, also between double quotes.
std::string EscapeMarkup(const std::string& text);

}  // namespace msf
