#include "tools/report/report_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace slalom::tools {
namespace {

constexpr const char* style = R"(
:root{color-scheme:light dark;--ink:#212938;--faint:#5a6478;--rule:#e3e7ee;--blue:#1f5fb5;--good:#1d7f4f;--bad:#a84a16;--paper:#fff;
--ground:#f3f5f9;--note:#fdf7e8;--code:#f6f8fb}
@media(prefers-color-scheme:dark){:root{--ink:#e6eaf1;--faint:#a3adbd;--rule:#303846;--blue:#84b6f5;--good:#1d7f4f;--bad:#a84a16;
--paper:#171c24;--ground:#0e1218;--note:#2d2614;--code:#0e1218}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.55 system-ui,"Segoe UI",Helvetica,Arial,sans-serif}
main{max-width:1320px;margin:0 auto;padding:36px 28px 80px}
h1{font-size:31px;line-height:1.2;margin:0 0 6px;letter-spacing:-.01em}
h2{font-size:21px;margin:0 0 4px}
h3{font-size:15px;margin:20px 0 6px;color:var(--faint);font-weight:600}
p{margin:6px 0;max-width:92ch}
.sub,.caption{color:var(--faint)}
.caption{font-size:13.5px}
section{background:var(--paper);border:1px solid var(--rule);border-radius:12px;padding:24px 26px;margin-top:22px}
.note{border-left:3px solid #e0a030;background:var(--note);padding:8px 14px;border-radius:0 8px 8px 0;margin-top:14px}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:14px;font-variant-numeric:tabular-nums}
th{font-weight:600;color:var(--faint);text-align:right;padding:6px 10px;border-bottom:2px solid var(--rule);font-size:13px;
white-space:nowrap}
td{text-align:right;padding:7px 10px;border-bottom:1px solid var(--rule);vertical-align:top;white-space:nowrap}
th:first-child,td:first-child{text-align:left;padding-left:0}
td.words,th.words{text-align:left}
tr.explained td{border-bottom:0;padding-bottom:1px}
tr.why td{text-align:left;white-space:normal;color:var(--faint);font-size:13px;padding:0 10px 8px 16px}
td small{color:var(--faint);font-size:12.5px}
@media(max-width:1300px){td small{display:block}th{white-space:normal;vertical-align:bottom}td:first-child{white-space:normal}}
.pill{display:inline-block;border-radius:99px;padding:0 9px;font-size:12.5px;font-weight:600;color:#fff;background:var(--faint)}
.inside{background:var(--good)}.outside{background:var(--bad)}
img{max-width:100%;max-height:1000px;display:block;margin:14px auto 6px;background:#fff;border-radius:8px;padding:6px}
details{margin-top:10px}summary{cursor:pointer;color:var(--blue)}
pre{overflow-x:auto;background:var(--code);padding:12px;border-radius:8px;font-size:12.5px}
@media(max-width:600px){main{padding:18px 10px 40px}section{padding:14px 12px}h1{font-size:24px}h2{font-size:18px}
td,th{padding:5px 6px}}
@media print{body{background:#fff}section{break-inside:avoid;border:0;padding:8px 0}}
)";

}  // namespace

const char* report_style() noexcept {
  return style;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "\xE2\x80\x93";
  char text[40];
  std::snprintf(text, sizeof text, "%.*f",
                value >= 100  ? 1
                : value >= 10 ? std::min(digits, 2)
                              : digits,
                value);
  return text;
}

std::string p_value(double p) {
  return p < 0.001 ? "&lt; 0.001" : number(p);
}

}  // namespace slalom::tools
