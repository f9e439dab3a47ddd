// Compresses the built page into the file that the program carries; `--check` compares instead of writing.
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { gzipSync } from "fflate";

const most = 150_000; // bytes
const packed = Buffer.from(gzipSync(readFileSync("dist/index.html"), { level: 9, mtime: "1980-01-01" }));
if (packed.length > most) {
  console.error(`the page has ${packed.length} bytes compressed; at most ${most} are allowed`);
  process.exit(1);
}
// What the page was made from, in sha256sum's form: tests compare it without Node.
const sources = ["index.html", "package.json", "package-lock.json", "tsconfig.json", "vite.config.js", ...readdirSync("src").sort().map((name) => "src/" + name)];
const sums = sources.map((name) => `${createHash("sha256").update(readFileSync(name)).digest("hex")}  ${name}\n`).join("");
if (process.argv.includes("--check")) {
  if (!packed.equals(readFileSync("built/index.html.gz")) || sums !== readFileSync("built/sources.sha256", "utf8")) {
    console.error("view/page/built/index.html.gz is not what the sources make: run npm run build and commit it");
    process.exit(1);
  }
  console.log(`the page is what its sources make: ${packed.length} bytes compressed`);
} else {
  writeFileSync("built/index.html.gz", packed);
  writeFileSync("built/sources.sha256", sums);
  console.log(`built/index.html.gz: ${packed.length} bytes`);
}
