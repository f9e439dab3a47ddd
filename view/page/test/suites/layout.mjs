// The page at other sizes and in light colours.
import assert from "node:assert/strict";

export default async function (h) {
  const { page } = h;

  await h.test("fits a phone, in light and dark colours", async () => {
    await page.click("#theme");
    await h.drawn();
    await h.picture("light");
    await page.setViewportSize({ width: 400, height: 800 });
    await h.drawn();
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "nothing reaches beyond 400 pixels");
    await h.picture("phone-light");
    await page.click("#theme");
    await h.drawn();
    await h.picture("phone");
    await page.setViewportSize({ width: 2560, height: 1300 });
    await h.drawn();
    await h.picture("wide");
    await page.setViewportSize({ width: 1280, height: 720 });
  });
}
