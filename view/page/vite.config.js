import { defineConfig } from "vite";

/** Puts script and styles into the page, so that it is one file. */
function singleFile() {
  return {
    name: "single-file",
    enforce: "post",
    generateBundle(_, bundle) {
      const page = bundle["index.html"];
      let html = page.source;
      for (const [name, item] of Object.entries(bundle)) {
        if (item.type === "chunk") {
          const tag = new RegExp(`<script[^>]*src="[^"]*${name}"[^>]*></script>`);
          const code = item.code.trim().replace(/<\/script/g, "<\\/script");
          html = html.replace(tag, "").replace("</body>", () => `<script type="module">${code}</script></body>`);
          delete bundle[name];
        } else if (name.endsWith(".css")) {
          const tag = new RegExp(`<link[^>]*href="[^"]*${name}"[^>]*>`);
          html = html.replace(tag, () => `<style>${item.source}</style>`);
          delete bundle[name];
        }
      }
      page.source = html;
    },
  };
}

export default defineConfig({
  base: "./",
  build: { target: "es2022", assetsInlineLimit: 1e8, cssCodeSplit: false, modulePreload: false, emptyOutDir: true },
  plugins: [singleFile()],
});
