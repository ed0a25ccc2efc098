"""What an account is refused, in both languages; every refusal says what to do instead."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["REFUSALS", "PeopleError"]

REFUSALS: Mapping[str, tuple[str, str]] = {  # key: zh, en
    "address": (
        "这不是电子邮箱地址，请写成 name@example.org 的形式。",
        "This is no e-mail address: write it as name@example.org.",
    ),
    "address-taken": (
        "这个邮箱已有账户，请登录；忘记密码可向前台索取一次性代码。",
        "There is an account with this address: sign in, or ask the desk for a one-time code.",
    ),
    "name": (
        "名字最多 {most} 个字，不能含控制字符。",
        "A name has at most {most} characters, and no control characters.",
    ),
    "password-short": (
        "密码至少 {least} 个字符；几个词连起来最好记。",
        "A password has at least {least} characters: a few words in a row are easy to keep.",
    ),
    "password-long": ("密码最多 {most} 个字符。", "A password has at most {most} characters."),
    "password-plain": (
        "这个密码太容易猜到：至少要有 {least} 个不同的字符，且不含邮箱名。",
        "This password is easily guessed: use at least {least} different characters, and not your address.",
    ),
    "password-wrong": ("密码不对，请再试一次。", "The password is wrong: try again."),
    "sign-in": (
        "邮箱、密码或验证码不对，请再试一次；忘记密码可向前台索取一次性代码。",
        "Address, password or authenticator code is wrong: try again, or ask the desk for a one-time code.",
    ),
    "no-office": (
        "这个账户没有工作人员角色，请联系管理员。",
        "This account has no role in the house: ask an administrator.",
    ),
    "too-often": (
        "尝试次数过多，请在 {seconds} 秒后再试。",
        "Too many attempts: try again in {seconds} seconds.",
    ),
    "code": (
        "代码不对、已用过或已过期，请向前台索取新的。",
        "The code is wrong, used or out of date: ask the desk for a new one.",
    ),
    "authenticator": (
        "验证码不对，请核对手机时间，输入最新的六位数字。",
        "The authenticator's code is wrong: check the phone's clock and give the newest six digits.",
    ),
    "no-account": (
        "没有这个邮箱的账户，请核对地址。",
        "There is no account with this address: check how it is written.",
    ),
    "no-session": (
        "没有这个登录会话，可能已经结束。",
        "There is no such session: it may have ended already.",
    ),
    "role": ("没有这个角色，请从 {roles} 中选择。", "There is no such role: choose one of {roles}."),
    "last-administrator": (
        "这是最后一位管理员，请先任命另一位。",
        "This is the last administrator: name another one first.",
    ),
    "no-exhibit": (
        "没有这件展品，请从展品目录中选择。",
        "There is no such exhibit: choose one from the catalogue.",
    ),
    "favourites-full": (
        "收藏已满（{most} 件），请先移除一些。",
        "There are {most} favourites, which is all there is room for: take some out first.",
    ),
    "again-differs": ("两次输入的密码不一致，请重新输入。", "The two passwords differ: type both again."),
    "not-allowed": (
        "您的角色不能做这件事；此次尝试已记入审计。需要时请联系管理员。",
        "Your role does not allow this, and the attempt is on record: ask an administrator if you need it.",
    ),
    "form": (
        "这个表单已过期或来自其他网站，请重新打开本页再试。",
        "This form is out of date or comes from elsewhere: open the page again and repeat.",
    ),
    "form-size": (
        "提交的内容过大或格式不对，请缩短后再试。",
        "What was sent is too large or no form: shorten it and repeat.",
    ),
}


class PeopleError(ValueError):
    """A refusal of the table. Its text is English; `text("zh")` is the other."""

    def __init__(self, key: str, **figures: object) -> None:
        self.key, self.figures = key, figures
        super().__init__(self.text("en"))

    def text(self, language: str) -> str:
        zh, en = REFUSALS[self.key]
        return (zh if language == "zh" else en).format(**self.figures)
