/** Templates of HTML keep their lines: spaces count in them. */
export default { printWidth: 110, embeddedLanguageFormatting: "off" };
