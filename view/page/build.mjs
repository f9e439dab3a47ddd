// Builds the page into one compressed file, which the program contains; `--check` compares instead.
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { build } from "esbuild";
import { gzipSync } from "fflate";

const bundle = await build({
  entryPoints: ["src/main.ts"],
  outdir: "dist",
  bundle: true,
  minify: true,
  write: false,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  legalComments: "none",
});
const built = (ending) => bundle.outputFiles.find((file) => file.path.endsWith(ending)).text.trim();
const sha256 = (content, encoding) => createHash("sha256").update(content).digest(encoding);

const entry = '<script type="module" src="/src/main.ts"></script>';
const source = readFileSync("index.html", "utf8").replace(/\n\s*/g, "\n");
if (!source.includes(entry)) throw new Error(`index.html must contain ${entry}`);
const script = built(".js").replace(/<\/script/g, "<\\/script");
// Only this script may run, neither one that a file brings nor a handler in HTML.
const policy = [
  "default-src 'none'",
  `script-src 'sha256-${sha256(script, "base64")}'`,
  "style-src 'unsafe-inline'",
  "img-src data: blob:",
  "media-src blob:",
  "connect-src 'self' ws: wss:",
  "worker-src 'self'",
  "base-uri 'none'",
].join("; ");
const declared = `<meta http-equiv="Content-Security-Policy" content="${policy}" />`;
const html = source
  .replace(entry, () => `<script type="module">${script}</script>`)
  .replace('<meta charset="utf-8" />', (first) => first + declared)
  .replace("</head>", () => `<style>${built(".css")}</style></head>`);
mkdirSync("dist", { recursive: true });
writeFileSync("dist/index.html", html);

const packed = Buffer.from(gzipSync(Buffer.from(html), { level: 9, mtime: "1980-01-01" }));
// The sources of the page in the form of sha256sum: tests compare them without Node.
const inside = readdirSync("src", { recursive: true }).filter((name) => /\.\w+$/.test(name));
const settings = ["index.html", "package.json", "package-lock.json", "tsconfig.json", "build.mjs"];
const sources = [...settings, ...inside.sort().map((name) => "src/" + name)];
const sums = sources.map((name) => `${sha256(readFileSync(name), "hex")}  ${name}\n`).join("");
if (!process.argv.includes("--check")) {
  writeFileSync("built/index.html.gz", packed);
  writeFileSync("built/sources.sha256", sums);
  console.log(`built/index.html.gz: ${packed.length} bytes`);
} else if (
  packed.equals(readFileSync("built/index.html.gz")) &&
  sums === readFileSync("built/sources.sha256", "utf8")
) {
  console.log(`The page matches its sources: ${packed.length} bytes compressed.`);
} else {
  const advice = "run npm run build and commit the result";
  console.error(`view/page/built/index.html.gz does not match its sources: ${advice}.`);
  process.exit(1);
}
